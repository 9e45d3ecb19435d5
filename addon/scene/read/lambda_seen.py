# SPDX-License-Identifier: GPL-3.0-or-later
"""λ as it is seen at each frame, whatever it comes from.

Plain keys are read from their F-curve. All else (drivers, NLA strips, scripts) Blender itself evaluates, frame by
frame. Frames are those of the scene's timeline, whole or not, before its time remapping.
"""

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np

from ...model.errors import InputError
from .lambda_source import plain_keys, varies, why_sampled
from .places import Places

#: Most frames at which animated elements are read.
MAX_POINTS = 240
#: Frames that are searched for where λ passes a value.
MAX_FRAMES = 100_000
#: Change of λ from frame to frame that counts as motion.
STILL = 1e-6


def lambda_at_frames(context: bpy.types.Context, obj: bpy.types.Object, frames: Sequence[float]) -> list[float]:
    """λ at each frame, 0 to 1. Goes through the frames of the scene where λ does not come from plain keys, and back."""
    curve = plain_keys(obj)
    if curve is not None:
        stretch = time_stretch(context.scene)
        values = [curve.evaluate(frame * stretch) for frame in frames]
    elif why_sampled(obj):
        values = _evaluated(context, obj, frames)
    else:
        values = [obj.stormfield.lam] * len(frames)
    return [min(1.0, max(0.0, value)) for value in values]


def lambda_frames(context: bpy.types.Context, obj: bpy.types.Object) -> list[int]:
    """The frames over which λ changes, between the first and the last key or all of the scene, thinned to at most
    MAX_POINTS."""
    if not varies(obj):
        raise InputError(
            f"λ of '{obj.name}' has no keyframes; key it twice (Key λ in the Field panel) so that frames "
            "and λ belong together"
        )
    first, last = lambda_range(context.scene, obj)
    step = max(1, -(-(last - first) // MAX_POINTS))
    frames = list(range(first, last + 1, step))
    return frames if frames[-1] == last else [*frames, last]


def lambda_range(scene: bpy.types.Scene, obj: bpy.types.Object) -> tuple[int, int]:
    """First and last frame over which λ changes: of its keys, else of the scene."""
    curve = plain_keys(obj)
    if curve is None or len(curve.keyframe_points) < 2:
        return scene.frame_start, scene.frame_end
    first, last = (round(end / time_stretch(scene)) for end in curve.range())
    if len(curve.modifiers):  # they go on beyond the keys
        first, last = min(first, scene.frame_start), max(last, scene.frame_end)
    return first, last


def lambda_per_second(context: bpy.types.Context, obj: bpy.types.Object) -> float:
    """Mean rate of λ between its first and its last key, or while it moves; 1 where it stands."""
    scene, curve = context.scene, plain_keys(obj)
    second = scene.render.fps / scene.render.fps_base
    if curve is not None and len(curve.keyframe_points) > 1:
        ends = curve.range()
        rate = abs(curve.evaluate(ends[1]) - curve.evaluate(ends[0])) * second * time_stretch(scene)
        return rate / (ends[1] - ends[0]) if rate > 0 and ends[1] > ends[0] else 1.0
    if not varies(obj):
        return 1.0
    steps = np.abs(np.diff(lambda_at_frames(context, obj, lambda_frames(context, obj))))
    spacing = (scene.frame_end - scene.frame_start) / max(1, len(steps))
    moving = steps[steps > STILL]
    return float(moving.mean() * second / spacing) if len(moving) and spacing > 0 else 1.0


def passages(context: bpy.types.Context, obj: bpy.types.Object, lams: Sequence[float]) -> list[list[tuple[int, bool]]]:
    """For every λ the frames where the λ that is seen passes it, and whether forward; none where λ does not change."""
    if not varies(obj):
        return [[] for _ in lams]
    first, last = lambda_range(context.scene, obj)
    frames = np.arange(first, min(last, first + MAX_FRAMES) + 1)
    values = np.array(lambda_at_frames(context, obj, frames.tolist()))
    before, after = values[:-1], values[1:]
    found = []
    for lam in lams:
        crossed = np.flatnonzero((before < lam) & (after >= lam) | (before >= lam) & (after < lam))
        fraction = (lam - before[crossed]) / (after[crossed] - before[crossed])
        at = np.rint(frames[crossed] + fraction).astype(int)
        found.append([(int(frame), bool(up)) for frame, up in zip(at, (after > before)[crossed], strict=True)])
    return found


def lambda_alone(context: bpy.types.Context, obj: bpy.types.Object, frames: Sequence[float]) -> list[float]:
    """The same from what λ itself depends on: the window stays as it is, and a large scene costs nothing. Scripts that
    set λ have no part in it."""
    shown, scene, copy = context.scene, bpy.data.scenes.new("Stormfield λ"), _bare_copy(obj)
    values = []
    try:
        scene.render.frame_map_old, scene.render.frame_map_new = shown.render.frame_map_old, shown.render.frame_map_new
        scene.collection.objects.link(copy)
        for frame in frames:
            whole = int(np.floor(frame))
            scene.frame_set(whole, subframe=float(frame - whole))
            values.append(copy.evaluated_get(scene.view_layers[0].depsgraph).stormfield.lam)
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.scenes.remove(scene)
    return [min(1.0, max(0.0, value)) for value in values]


def _bare_copy(obj: bpy.types.Object) -> Any:
    copy: Any = obj.copy()
    copy.stormfield.enabled = False
    copy.modifiers.clear()
    copy.constraints.clear()
    copy.parent = None
    copy.hide_viewport = False
    return copy


def time_stretch(scene: bpy.types.Scene) -> float:
    """Time of animation that passes from one frame to the next (Time Stretching in the output settings)."""
    return scene.render.frame_map_old / scene.render.frame_map_new


def _evaluated(context: bpy.types.Context, obj: bpy.types.Object, frames: Sequence[float]) -> list[float]:
    scene = context.scene
    before = scene.frame_current, scene.frame_subframe
    values = []
    with Places(context) as places:
        try:
            for frame in frames:
                whole = int(np.floor(frame))
                places.at_frame(whole, float(frame - whole))
                values.append(places.of(obj).evaluated.stormfield.lam)
        finally:
            places.at_frame(*before)
    return values
