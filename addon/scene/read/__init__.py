# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender → plain data: the only place where the pipeline reads a scene."""
