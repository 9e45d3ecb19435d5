# SPDX-License-Identifier: GPL-3.0-or-later
"""State of this Blender session, known by the session uid of its object. Never saved."""
