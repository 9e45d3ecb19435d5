# SPDX-License-Identifier: GPL-3.0-or-later
"""When strokes move, and how far: with the frames at playback, by the clock while the pointer is over a view.

Nothing moves, and nothing is drawn again, REST seconds after the pointer has left or lies still.
"""

import time

import bpy

#: Strokes that a dash runs through in a second.
SPEED = 0.8
#: Seconds that motion goes on after the pointer moved, and between two pictures of it.
REST, TICK = 1.5, 1.0 / 24.0

_touched: dict[int, float] = {}  #: when the pointer was last seen, by region


def pointer_moved(context: bpy.types.Context) -> None:
    """Called when the pointer moves over a view."""
    _touched[context.region.as_pointer()] = time.monotonic()
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=TICK)


def phase(context: bpy.types.Context) -> float | None:
    """How many strokes dashes have run through, modulo 1; None while they rest."""
    if context.screen is not None and context.screen.is_animation_playing:
        render = context.scene.render
        return context.scene.frame_current_final * render.fps_base / render.fps * SPEED % 1.0
    if context.region.as_pointer() in _touched:
        return time.monotonic() * SPEED % 1.0
    return None


def forget() -> None:
    _touched.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    """Draw the views that move; those whose time is over once more, at rest."""
    if not _touched:
        return None
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                for region in area.regions:
                    if region.as_pointer() in _touched:
                        region.tag_redraw()
    now = time.monotonic()
    for region_number, touched in list(_touched.items()):
        if now - touched > REST:
            del _touched[region_number]
    return TICK
