# SPDX-License-Identifier: GPL-3.0-or-later
"""Copied objects get cache files of their own as soon as they are there; asked at every update, so answered quickly."""

import bpy

from ..scene.write import cache_files

_seen: tuple[object, ...] = ()


def part_new_copies() -> None:
    """Parts what objects share, when objects or cache files have come since the last time."""
    global _seen
    if _state() != _seen:
        cache_files.part_copies()
        _seen = _state()


def _state() -> tuple:
    blocks = ((file.session_uid, file.users, cache_files.followed(file) is None) for file in bpy.data.cache_files)
    return (len(bpy.data.objects), *blocks)
