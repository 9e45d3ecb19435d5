# SPDX-License-Identifier: GPL-3.0-or-later
"""λ keyed over frames."""

import bpy

from ... import compat


def key_lambda_over_scene(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    """λ runs evenly from 0 at the first frame of the scene to 1 at the last."""
    key_lambda(obj, scene.frame_start, max(scene.frame_end, scene.frame_start + 1), scene.frame_current)


def key_lambda(obj: bpy.types.Object, first: int, last: int, now: int) -> None:
    """Two linear keys, 0 at the first frame and 1 at the last; λ gets its value at frame `now`. Earlier keys go."""
    old = compat.find_fcurve(obj, "stormfield.lam")
    if old is not None:
        compat.remove_fcurve(obj, old)
    field = obj.stormfield
    for frame, value in ((last, 1.0), (first, 0.0)):
        field.lam = value
        field.keyframe_insert("lam", frame=frame)
    curve = compat.find_fcurve(obj, "stormfield.lam")
    for key in curve.keyframe_points:
        key.interpolation = "LINEAR"
    curve.update()
    field.lam = min(1.0, max(0.0, curve.evaluate(now)))
