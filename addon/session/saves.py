# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last save could not bring along, as the panel and a message say it."""

import sys

import bpy

from ..scene.write.cache_folders import Saving
from ..scene.write.mirror import Mirrored

_saving: Saving | None = None
_mirrored: Mirrored | None = None
_refused: tuple[str, ...] = ()


def begin(saving: Saving) -> None:
    """The file is about to be written."""
    global _saving, _refused
    _saving, _refused = saving, tuple(saving.refused)
    for sentence in _refused:
        print(f"stormfield: {sentence}", file=sys.stderr)
    if _refused and not bpy.app.background:
        bpy.app.timers.register(_tell, first_interval=0.1)


def keep_lambda(mirrored: Mirrored) -> None:
    """The file is about to be written, and plays its λ without the add-on."""
    global _mirrored
    _mirrored = mirrored
    for remark in mirrored.remarks:
        print(f"stormfield: {remark}")


def end() -> None:
    """The file that was written is the open one now."""
    global _saving, _mirrored
    if _mirrored is not None:
        _mirrored.undo()
    _saving = _mirrored = None


def end_as_copy() -> None:
    """The file that was written is another one: the open file keeps its paths."""
    if _saving is not None:
        _saving.undo()
    end()


def refused() -> tuple[str, ...]:
    """Sentences on the caches that could not be brought to the file."""
    return _refused


def forget() -> None:
    global _saving, _mirrored, _refused
    _saving = _mirrored = None
    _refused = ()


def _tell() -> None:
    def draw(menu, _context):
        for sentence in _refused:
            menu.layout.label(text=sentence)

    bpy.context.window_manager.popup_menu(
        draw, title="Caches stay where they are; save again to try again", icon="ERROR"
    )
