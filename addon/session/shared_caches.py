# SPDX-License-Identifier: GPL-3.0-or-later
"""Copied objects get cache files of their own as soon as they are there; asked at every update, so answered quickly."""

import bpy

from ..scene.write import cache_files

_seen: tuple[object, ...] = ()


def part_new_copies() -> None:
    """Parts what objects share, when objects or cache files have come since the last time."""
    global _seen
    now = _state()
    if now != _seen:
        if any(users > 1 or linked for _uid, users, linked in now[1:]):
            cache_files.part_copies()
            now = _state()
        _seen = now


def _state() -> tuple:
    blocks = ((file.session_uid, file.users, file.library is not None) for file in bpy.data.cache_files)
    return (len(bpy.data.objects), *blocks)
