# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender scene: read into plain data, written from plain data, and node trees built from expressions."""
