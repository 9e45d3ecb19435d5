# SPDX-License-Identifier: GPL-3.0-or-later
"""λ's F-curve, copied onto the cache file: a scene keeps its animation where the add-on is not installed.

With the add-on a driver sets the cache file's frame from λ, keyed or not. Without it Blender does not know the property
λ, the driver is invalid and leaves the value alone, so that the F-curve below it counts. So renders need no Python, and
the copy only has to be right when the file is saved.
"""

import bpy

from ... import compat
from ...cache.layout import TIME_CODES_PER_LAMBDA as TIME_CODES
from ..read.attached import OVER_LAMBDA, find_modifier

HANDLES = ("handle_left", "handle_right")


def mirror_lambda(obj: bpy.types.Object) -> None:
    """Copy the F-curve of the object's λ, times TIME_CODES; none where λ is not keyed."""
    for name in OVER_LAMBDA:
        modifier = find_modifier(obj, name)
        if modifier is not None and modifier.cache_file is not None:
            _mirror(obj, modifier.cache_file)


def mirror_all() -> None:
    for obj in bpy.data.objects:
        if obj.type == "MESH" and obj.is_editable and obj.stormfield.enabled:
            mirror_lambda(obj)


def _mirror(obj: bpy.types.Object, cache_file: bpy.types.CacheFile) -> None:
    old = compat.find_fcurve(cache_file, "frame")
    if old is not None:
        compat.remove_fcurve(cache_file, old)
    curve = compat.find_fcurve(obj, "stormfield.lam")
    if curve is None or len(curve.keyframe_points) == 0:
        return
    for key in curve.keyframe_points:
        cache_file.keyframe_insert("frame", frame=key.co.x)
    copy = compat.find_fcurve(cache_file, "frame")
    copy.extrapolation = curve.extrapolation
    for mine, key in zip(copy.keyframe_points, curve.keyframe_points, strict=True):
        mine.interpolation, mine.easing = key.interpolation, key.easing
        mine.back, mine.amplitude, mine.period = key.back, key.amplitude, key.period
        mine.handle_left_type = mine.handle_right_type = "FREE"
        mine.co = (key.co.x, key.co.y * TIME_CODES)
        for handle in HANDLES:
            place = getattr(key, handle)
            setattr(mine, handle, (place.x, place.y * TIME_CODES))
    copy.update()
