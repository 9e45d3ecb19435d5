"""Geometry Nodes that show flow curves over the frames: renders follow them without the add-on.

Curves grow by their point attribute `time` (seconds of the scene), or change by their curve attribute `frame`.
"""

from typing import Any

import bpy

from ... import compat

#: Modifier that this module owns on a Curves object.
MODIFIER = "Stormfield Growth"
GROW, FRAMES = "Stormfield Grow with Time", "Stormfield Show by Frame"
#: Seconds by which a point counts as reached: far less than a frame, more than single precision loses in half an hour.
SLACK = 1e-4


def show_growing(curves: bpy.types.Object, tail: float) -> None:
    """Show what lies between now and `tail` seconds before (0: everything since the start)."""
    modifier = _modifier(curves, _grow_group())
    compat.set_modifier_input(modifier, _identifier(modifier, "Tail"), tail)


def show_by_frame(curves: bpy.types.Object, first: int, last: int) -> None:
    """Show the curves of the current frame; before the first and after the last frame those of that one."""
    modifier = _modifier(curves, _frames_group())
    for name, value in (("First", first), ("Last", last)):
        compat.set_modifier_input(modifier, _identifier(modifier, name), value)


def _modifier(curves: bpy.types.Object, group: bpy.types.NodeTree) -> bpy.types.NodesModifier:
    modifier: Any = curves.modifiers.get(MODIFIER) or curves.modifiers.new(MODIFIER, "NODES")
    if modifier.node_group != group:
        modifier.node_group = group
    return modifier


def _identifier(modifier: bpy.types.NodesModifier, name: str) -> str:
    return next(item.identifier for item in modifier.node_group.interface.items_tree if item.name == name)


def _new_group(name: str, inputs: dict[str, str]) -> tuple[bpy.types.NodeTree, bpy.types.Node, bpy.types.Node]:
    group: Any = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group.is_modifier = True
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    for socket, kind in inputs.items():
        group.interface.new_socket(socket, in_out="INPUT", socket_type=kind)
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    return group, _node(group, "NodeGroupInput", 0), _node(group, "NodeGroupOutput", 5)


def _node(group: bpy.types.NodeTree, kind: str, column: int, row: int = 0, **settings) -> bpy.types.Node:
    node = group.nodes.new(kind)
    node.location = (column * 190.0, row * -160.0)
    for name, value in settings.items():
        setattr(node, name, value)
    return node


def _math(group, column: int, row: int, operation: str, *operands) -> bpy.types.NodeSocket:
    node = _node(group, "ShaderNodeMath", column, row, operation=operation)
    for operand, socket in zip(operands, node.inputs, strict=False):
        if isinstance(operand, bpy.types.NodeSocket):
            group.links.new(operand, socket)
        else:
            socket.default_value = operand
    return node.outputs[0]


def _attribute(group, name: str, data_type: str, row: int) -> bpy.types.NodeSocket:
    node = _node(group, "GeometryNodeInputNamedAttribute", 0, row, data_type=data_type)
    node.inputs["Name"].default_value = name
    return next(socket for socket in node.outputs if socket.enabled and socket.name == "Attribute")


def _delete(group, given, result, domain: str, selection: bpy.types.NodeSocket) -> None:
    node = _node(group, "GeometryNodeDeleteGeometry", 4, domain=domain)
    group.links.new(given.outputs["Geometry"], node.inputs["Geometry"])
    group.links.new(selection, node.inputs["Selection"])
    group.links.new(node.outputs["Geometry"], result.inputs["Geometry"])


def _grow_group() -> bpy.types.NodeTree:
    """Deletes points whose time is still to come, and those older than the tail."""
    group = bpy.data.node_groups.get(GROW)
    if group is not None:
        return group
    group, given, result = _new_group(GROW, {"Tail": "NodeSocketFloat"})
    time = _attribute(group, "time", "FLOAT", 1)
    now = _node(group, "GeometryNodeInputSceneTime", 0, 2).outputs["Seconds"]
    age = _math(group, 1, 1, "SUBTRACT", now, time)
    to_come = _math(group, 2, 1, "LESS_THAN", age, -SLACK)
    old = _math(group, 2, 2, "GREATER_THAN", age, _math(group, 1, 3, "ADD", given.outputs["Tail"], SLACK))
    has_tail = _math(group, 2, 3, "GREATER_THAN", given.outputs["Tail"], 0.0)
    _delete(
        group,
        given,
        result,
        "POINT",
        _math(group, 3, 1, "MAXIMUM", to_come, _math(group, 3, 2, "MULTIPLY", old, has_tail)),
    )
    return group


def _frames_group() -> bpy.types.NodeTree:
    """Deletes the curves of other frames."""
    group = bpy.data.node_groups.get(FRAMES)
    if group is not None:
        return group
    group, given, result = _new_group(FRAMES, {"First": "NodeSocketInt", "Last": "NodeSocketInt"})
    frame = _attribute(group, "frame", "INT", 1)
    now = _math(group, 1, 2, "FLOOR", _node(group, "GeometryNodeInputSceneTime", 0, 2).outputs["Frame"])
    shown = _math(
        group, 2, 2, "MINIMUM", _math(group, 1, 3, "MAXIMUM", now, given.outputs["First"]), given.outputs["Last"]
    )
    away = _math(group, 3, 1, "ABSOLUTE", _math(group, 2, 1, "SUBTRACT", frame, shown))
    _delete(group, given, result, "CURVE", _math(group, 3, 2, "GREATER_THAN", away, 0.5))
    return group
