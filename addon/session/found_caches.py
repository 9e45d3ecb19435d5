# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished caches that belong to the open scene but are not shown: a farm has baked them since the file was saved.

found_caches.look()           # after a file was loaded, when Blender is at rest
found_caches.offered(obj)     # ["field", "flowing texture"]; empty where there is nothing to offer
"""

import bpy

from ..bake.finished import Finished
from ..model.errors import InputError
from ..scene.read.finished_caches import are_any, not_shown, read_finished
from ..scene.read.lambda_source import why_sampled

#: Seconds after a file was loaded until its caches are looked for: its window appears first.
DELAY = 0.5

_found: dict[int, Finished] = {}  #: by session uid


def look_soon() -> None:
    """Called when a file was loaded. Without a window nobody could be asked."""
    _found.clear()
    if not bpy.app.background and not bpy.app.timers.is_registered(look):
        bpy.app.timers.register(look, first_interval=DELAY)


def look() -> None:
    """Looks for the caches of every field of the scene."""
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and obj.stormfield.enabled and obj.mode != "EDIT" and are_any(obj):
            if why_sampled(obj):  # looking would go through the frames of a scene that was just opened
                continue
            try:
                _found[obj.session_uid] = read_finished(bpy.context, obj)
            except InputError:  # Solve says what is wrong
                continue
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def offered(obj: bpy.types.Object) -> list[str]:
    """What the caches are that were found for an object, for its panel."""
    found = _found.get(obj.session_uid)
    return [] if found is None else not_shown(obj, found)


def forget(obj: bpy.types.Object) -> None:
    """Offer nothing more for an object: it was solved anew, or shows what was found."""
    _found.pop(obj.session_uid, None)


def stop() -> None:
    _found.clear()
    if bpy.app.timers.is_registered(look):
        bpy.app.timers.unregister(look)
