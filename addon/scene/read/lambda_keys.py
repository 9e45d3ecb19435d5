# SPDX-License-Identifier: GPL-3.0-or-later
"""The keys of λ: which frame shows which λ."""

import bpy
import numpy as np

from ... import compat
from ...model.errors import InputError

#: Most frames at which animated elements are read.
MAX_POINTS = 240
#: Frames between keys that are searched for where λ passes a value.
MAX_FRAMES = 100_000


def lambda_frames(obj: bpy.types.Object) -> list[int]:
    """The frames between the first and the last key of λ, thinned to at most MAX_POINTS."""
    curve = compat.find_fcurve(obj, "stormfield.lam")
    if curve is None or len(curve.keyframe_points) < 2:
        raise InputError(
            f"λ of '{obj.name}' has no keyframes; key it twice (Key λ in the Field panel) so that frames "
            "and λ belong together"
        )
    ends = curve.range()
    first, last = round(ends[0]), round(ends[1])
    step = max(1, -(-(last - first) // MAX_POINTS))
    frames = list(range(first, last + 1, step))
    return frames if frames[-1] == last else [*frames, last]


def lambda_at_frames(obj: bpy.types.Object, frames: list[int]) -> list[float]:
    """λ at each frame, from the F-curve; the value as it stands where λ is not animated."""
    curve = compat.find_fcurve(obj, "stormfield.lam")
    values = [curve.evaluate(frame) if curve else obj.stormfield.lam for frame in frames]
    return [min(1.0, max(0.0, value)) for value in values]


def lambda_per_second(scene: bpy.types.Scene, obj: bpy.types.Object) -> float:
    """Mean rate of λ between its first and its last key; 1 where λ is not keyed."""
    curve = compat.find_fcurve(obj, "stormfield.lam")
    if curve is None or len(curve.keyframe_points) < 2:
        return 1.0
    ends = curve.range()
    rate = abs(curve.evaluate(ends[1]) - curve.evaluate(ends[0])) * scene.render.fps / scene.render.fps_base
    return rate / (ends[1] - ends[0]) if rate > 0 and ends[1] > ends[0] else 1.0


def passages(obj: bpy.types.Object, lams: list[float]) -> list[list[tuple[int, bool]]]:
    """For every λ the frames where the keyframed λ passes it, and whether forward; none where λ is not keyed."""
    if not is_keyed(obj):
        return [[] for _ in lams]
    curve = compat.find_fcurve(obj, "stormfield.lam")
    first, last = (round(end) for end in curve.range())
    frames = np.arange(first, min(last, first + MAX_FRAMES) + 1)
    values = np.clip([curve.evaluate(frame) for frame in frames], 0.0, 1.0)
    before, after = values[:-1], values[1:]
    found = []
    for lam in lams:
        crossed = np.flatnonzero((before < lam) & (after >= lam) | (before >= lam) & (after < lam))
        fraction = (lam - before[crossed]) / (after[crossed] - before[crossed])
        at = np.rint(frames[crossed] + fraction).astype(int)
        found.append([(int(frame), bool(up)) for frame, up in zip(at, (after > before)[crossed], strict=True)])
    return found


def is_keyed(obj: bpy.types.Object) -> bool:
    curve = compat.find_fcurve(obj, "stormfield.lam")
    return curve is not None and len(curve.keyframe_points) > 1
