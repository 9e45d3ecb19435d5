# SPDX-License-Identifier: GPL-3.0-or-later
"""F-curves with all values times a factor: keys, handles and modifiers."""

from typing import Any

import bpy
import numpy as np

HANDLES = ("handle_left", "handle_right")
#: Settings of F-curve modifiers that are values; all others are times, counts or choices.
VALUES = {
    "LIMITS": ("min_y", "max_y"),
    "FNGENERATOR": ("amplitude", "value_offset"),
    "ENVELOPE": ("reference_value", "default_min", "default_max"),
    "NOISE": ("strength",),
}
#: Places at which two curves are compared, in and around their keys.
PLACES = 97


def copy_scaled(target: bpy.types.FCurve, source: bpy.types.FCurve, factor: float) -> None:
    """Give `target`, which has keys at the same times, the shape of `source` times the factor."""
    target.extrapolation = source.extrapolation
    for mine, key in zip(target.keyframe_points, source.keyframe_points, strict=True):
        mine.interpolation, mine.easing = key.interpolation, key.easing
        mine.back, mine.amplitude, mine.period = key.back, key.amplitude, key.period
        mine.handle_left_type = mine.handle_right_type = "FREE"
        mine.co = (key.co.x, key.co.y * factor)
        for handle in HANDLES:
            place = getattr(key, handle)
            setattr(mine, handle, (place.x, place.y * factor))
    for modifier in source.modifiers:
        _copy_modifier(target.modifiers.new(modifier.type), modifier)
    _scale_modifiers(target, factor)
    target.update()


def scale(curve: bpy.types.FCurve, factor: float) -> None:
    """Multiply a curve's own values; one that has none passes on what it is given, as a driver's may."""
    for key in curve.keyframe_points:
        key.handle_left_type = key.handle_right_type = "FREE"
        key.co.y *= factor
        for handle in HANDLES:
            place = getattr(key, handle)
            setattr(key, handle, (place.x, place.y * factor))
    if not len(curve.keyframe_points) and not len(curve.modifiers):
        line: Any = curve.modifiers.new("GENERATOR")
        line.poly_order, line.coefficients = 1, (0.0, factor)
    else:
        _scale_modifiers(curve, factor)
    curve.update()


def set_points(curve: bpy.types.FCurve, points: np.ndarray) -> None:
    """Linear keys (n, 2), times and values, instead of those there are."""
    curve.keyframe_points.clear()
    curve.keyframe_points.add(len(points))
    curve.keyframe_points.foreach_set("co", np.ascontiguousarray(points, np.float32).ravel())
    for key in curve.keyframe_points:
        key.interpolation = "LINEAR"
    curve.update()


def is_multiple(curve: bpy.types.FCurve, source: bpy.types.FCurve, factor: float) -> bool:
    """Whether a curve is `source` times the factor, within a thousandth of it."""
    first, last = source.range() if len(source.keyframe_points) else (0.0, 1.0)
    reach = max(1.0, last - first)
    places = np.linspace(first - 1.3 * reach, last + 2.1 * reach, PLACES)
    return all(abs(curve.evaluate(place) - factor * source.evaluate(place)) < 1e-3 * factor for place in places)


def _copy_modifier(target: Any, source: Any) -> None:
    if source.type == "GENERATOR":  # these decide how many coefficients there are
        target.mode, target.poly_order = source.mode, source.poly_order
    for setting in source.bl_rna.properties:
        if not setting.is_readonly and setting.identifier not in {"name", "active"}:
            value = getattr(source, setting.identifier)
            setattr(target, setting.identifier, tuple(value) if getattr(setting, "is_array", False) else value)
    if source.type == "ENVELOPE":
        for point in source.control_points:
            mine = target.control_points.add(point.frame)
            mine.min, mine.max = point.min, point.max


def _scale_modifiers(curve: bpy.types.FCurve, factor: float) -> None:
    for modifier in curve.modifiers:
        each: Any = modifier
        if each.type == "GENERATOR":
            each.coefficients = tuple(factor * number for number in each.coefficients)
        elif each.type == "NOISE" and each.blend_type == "MULTIPLY":
            continue
        for name in VALUES.get(each.type, ()):
            setattr(each, name, factor * getattr(each, name))
        if each.type == "ENVELOPE":
            for point in each.control_points:
                point.min, point.max = factor * point.min, factor * point.max
