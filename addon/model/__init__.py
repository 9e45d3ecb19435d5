# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain data: designs and meshes. No bpy, no native module."""
