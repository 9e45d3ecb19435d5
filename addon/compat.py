# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the supported Blender versions, found by feature and never by version number."""

from collections.abc import Iterator

import bpy


def fcurves(owner: bpy.types.ID) -> Iterator[bpy.types.FCurve]:
    """All F-curves that animate `owner`: of its slot where actions are layered, of the whole action otherwise."""
    animation = owner.animation_data
    action = animation.action if animation else None
    if action is None:
        return
    if not hasattr(action, "layers") or not getattr(action, "is_action_layered", True):
        yield from action.fcurves
        return
    slot = animation.action_slot
    if slot is None:
        return
    for layer in action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(slot)
            if bag is not None:
                yield from bag.fcurves


def all_fcurves(action: bpy.types.Action) -> Iterator[bpy.types.FCurve]:
    """The F-curves of an action, of all its slots."""
    if not hasattr(action, "layers") or not getattr(action, "is_action_layered", True):
        yield from action.fcurves
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                yield from bag.fcurves


def find_fcurve(owner: bpy.types.ID, data_path: str) -> bpy.types.FCurve | None:
    return next((curve for curve in fcurves(owner) if curve.data_path == data_path), None)


def set_modifier_input(modifier: bpy.types.NodesModifier, identifier: str, value) -> None:
    """Set one input of a Geometry Nodes modifier (RNA inputs since 5.2, custom properties before)."""
    inputs = getattr(getattr(modifier, "properties", None), "inputs", None)
    if inputs is None:
        modifier[identifier] = value
    else:
        getattr(inputs, identifier).value = value


def builtin_shader(*names: str):
    """The first of the built-in GPU shaders that this Blender knows."""
    import gpu

    for name in names:
        try:
            return gpu.shader.from_builtin(name)
        except (ValueError, SystemError):
            continue
    raise RuntimeError(f"Blender has none of the shaders {', '.join(names)}")


def remove_fcurve(owner: bpy.types.ID, curve: bpy.types.FCurve) -> None:
    """Remove one F-curve of `owner`, as found by `fcurves`."""
    animation = owner.animation_data
    if not hasattr(animation.action, "layers"):
        animation.action.fcurves.remove(curve)
        return
    for layer in animation.action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(animation.action_slot)
            if bag is not None and any(own == curve for own in bag.fcurves):
                bag.fcurves.remove(curve)
                return
