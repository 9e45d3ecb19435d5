# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last save could not bring along, as the panel and a message say it."""

import sys

import bpy

from ..scene.write.cache_folders import Saving

_saving: Saving | None = None
_refused: tuple[str, ...] = ()


def begin(saving: Saving) -> None:
    """The file is about to be written."""
    global _saving, _refused
    _saving, _refused = saving, tuple(saving.refused)
    for sentence in _refused:
        print(f"stormfield: {sentence}", file=sys.stderr)
    if _refused and not bpy.app.background:
        bpy.app.timers.register(_tell, first_interval=0.1)


def end() -> None:
    """The file that was written is the open one now."""
    global _saving
    _saving = None


def end_as_copy() -> None:
    """The file that was written is another one: the open file keeps its paths."""
    if _saving is not None:
        _saving.undo()
    end()


def refused() -> tuple[str, ...]:
    """Sentences on the caches that could not be brought to the file."""
    return _refused


def forget() -> None:
    global _refused
    end()
    _refused = ()


def _tell() -> None:
    def draw(menu, _context):
        for sentence in _refused:
            menu.layout.label(text=sentence)

    bpy.context.window_manager.popup_menu(
        draw, title="Caches stay where they are; save again to try again", icon="ERROR"
    )
