# SPDX-License-Identifier: GPL-3.0-or-later
"""Flowing textures of an object in several scenes, whose frames or frame rates differ: each scene shows what was baked
for it.

An object has one list of modifiers for all scenes. Each bake of another scene gets a modifier of its own, which drivers
turn on in that scene alone; they need no permission to run scripts, and no add-on. A scene without a bake of its own
shows the first one.
"""

from collections.abc import Iterator

import bpy

from ..read.attached import FRAMES, SCENE, modifiers_of

#: What the drivers turn.
SWITCHES = ("show_viewport", "show_render")


def flow_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> bpy.types.Modifier | None:
    """The modifier for what is baked in that scene: its own, or one that belongs to no scene any more."""
    flows, number = modifiers_of(obj, FRAMES), number_of(scene)
    own = (flow for flow in flows if _mark(flow) == number)
    others = {other.get(SCENE) for other in bpy.data.scenes if other != scene and other.objects.get(obj.name) == obj}
    return next(own, None) or next((flow for flow in flows if _mark(flow) not in others), None)


def number_of(scene: bpy.types.Scene) -> int:
    """The number of a scene; a copy of a scene, which has that of the first, gets one of its own."""
    number = scene.get(SCENE)
    taken = {other.get(SCENE, 0) for other in bpy.data.scenes if other != scene}
    if number is None or number in taken:
        scene[SCENE] = number = 1 + max([*taken, *(file.get(SCENE, 0) for file in bpy.data.cache_files)])
    return number


def scene_of(flow: bpy.types.Modifier) -> bpy.types.Scene | None:
    """The scene whose bake a modifier shows."""
    return next((scene for scene in bpy.data.scenes if scene.get(SCENE, 0) == _mark(flow)), None)


def show_in_its_scene(obj: bpy.types.Object) -> None:
    """Turn each flowing texture on in the scene that it was baked for."""
    flows = modifiers_of(obj, FRAMES)
    for flow in flows:
        was_driven = any(drivers_of(obj, flow))
        for switch in SWITCHES:
            flow.driver_remove(switch)
        if len(flows) > 1:
            others = " and ".join(f"scene != {_mark(other)}" for other in flows if other != flow)
            _drive(flow, others if flow == flows[0] else f"scene == {_mark(flow)}")
        elif was_driven:
            flow.show_viewport = flow.show_render = True


def drivers_of(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> Iterator[bpy.types.FCurve]:
    """Those that turn a modifier on and off."""
    animation = obj.animation_data
    paths = {f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"].{switch}' for switch in SWITCHES}
    for curve in animation.drivers if animation else ():
        if curve.data_path in paths:
            yield curve


def _mark(flow: bpy.types.Modifier) -> int:
    return 0 if flow.cache_file is None else flow.cache_file.get(SCENE, 0)


def _drive(flow: bpy.types.Modifier, expression: str) -> None:
    for switch in SWITCHES:
        driver = flow.driver_add(switch).driver
        driver.type = "SCRIPTED"
        variable = driver.variables.new()
        variable.name, variable.type = "scene", "CONTEXT_PROP"
        target = variable.targets[0]
        target.context_property, target.data_path = "ACTIVE_SCENE", f'["{SCENE}"]'
        target.use_fallback_value, target.fallback_value = True, 0.0
        driver.expression = expression
