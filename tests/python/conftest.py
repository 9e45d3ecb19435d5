# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender first: its oneTBB must be loaded before the native module's, and its USD must be the only one."""

import contextlib

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401
