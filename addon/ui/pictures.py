# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the element presets, made by scripts/preset_pictures.py."""

from pathlib import Path

import bpy
import bpy.utils.previews

FOLDER = Path(__file__).with_name("preset_pictures")
_pictures = None


def of(name: str) -> int:
    """The picture's number for `icon_value`; 0, no picture, in background mode and for a name without one."""
    global _pictures
    path = FOLDER / f"{name.lower()}.png"
    if bpy.app.background or not path.is_file():
        return 0
    if _pictures is None:
        _pictures = bpy.utils.previews.new()
    if name not in _pictures:
        _pictures.load(name, str(path), "IMAGE")
    return _pictures[name].icon_id


def unregister() -> None:
    global _pictures
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None
