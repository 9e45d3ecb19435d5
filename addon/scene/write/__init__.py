# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain data → Blender: modifiers, objects, attributes, lists and timeline markers."""
