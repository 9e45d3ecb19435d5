# SPDX-License-Identifier: GPL-3.0-or-later
"""Where λ comes from: keys that can be read, or something that only Blender itself can evaluate."""

from collections.abc import Iterator
from types import CodeType, FunctionType
from typing import Any

import bpy

from ... import compat

#: The animated setting.
PATH = "stormfield.lam"


def driver_of(obj: bpy.types.Object) -> bpy.types.FCurve | None:
    """The driver of λ that is in effect."""
    animation = obj.animation_data
    drivers = animation.drivers if animation else ()
    return next((curve for curve in drivers if curve.data_path == PATH and not curve.mute), None)


def plain_keys(obj: bpy.types.Object) -> bpy.types.FCurve | None:
    """The F-curve that alone says what λ is at every time; it may have modifiers."""
    curve = compat.find_fcurve(obj, PATH)
    if curve is None or why_sampled(obj):
        return None
    return curve


def why_sampled(obj: bpy.types.Object) -> str:
    """What λ comes from where no single F-curve says it; empty where keys do, or where it is constant."""
    if driver_of(obj) is not None:
        return "a driver"
    if _is_in_nla(obj):
        return "NLA strips"
    curve = compat.find_fcurve(obj, PATH)
    if curve is not None:
        return "keys that are turned off in part" if _is_muted(curve) else ""
    return "a script" if is_scripted() else ""


def varies(obj: bpy.types.Object) -> bool:
    """Whether λ may differ from frame to frame."""
    curve = plain_keys(obj)
    if curve is None:
        return bool(why_sampled(obj))
    return len(curve.keyframe_points) > 1 or len(curve.modifiers) > 0


def is_scripted() -> bool:
    """Whether a script of the artist's sets λ when the frame changes."""
    handlers = bpy.app.handlers
    own = __package__.partition(".scene")[0]
    for function in (*handlers.frame_change_pre, *handlers.frame_change_post):
        if not str(getattr(function, "__module__", "")).startswith(own) and _names_lambda(function):
            return True
    return False


def _names_lambda(function: Any) -> bool:
    """Whether a function, or one of the module it is in, names Stormfield's settings."""
    found = [function, *getattr(function, "__globals__", {}).values()]
    codes = [each.__code__ for each in found if isinstance(each, FunctionType)]
    return any("stormfield" in names for code in codes for names in _names_in(code))


def _names_in(code: CodeType) -> Iterator[tuple[str, ...]]:
    yield code.co_names
    yield tuple(constant for constant in code.co_consts if isinstance(constant, str))
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names_in(constant)


def _is_in_nla(obj: bpy.types.Object) -> bool:
    animation = obj.animation_data
    if animation is None or not animation.use_nla:
        return False
    strips = [strip for track in animation.nla_tracks if not track.mute for strip in track.strips if not strip.mute]
    if animation.use_tweak_mode or any(_may_hold_lambda(strip) for strip in strips):
        return True
    mixed = animation.action_influence < 1.0 or animation.action_blend_type != "REPLACE"
    return bool(strips) and mixed and compat.find_fcurve(obj, PATH) is not None


def _may_hold_lambda(strip: bpy.types.NlaStrip) -> bool:
    return strip.action is None or any(curve.data_path == PATH for curve in compat.all_fcurves(strip.action))


def _is_muted(curve: bpy.types.FCurve) -> bool:
    return curve.mute or (curve.group is not None and curve.group.mute)
