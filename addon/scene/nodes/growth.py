# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that show flow curves over the frames: renders follow them without the add-on.

Curves grow by their point attribute `time` (seconds of the scene), or change by their curve attribute `frame`.
"""

from typing import Any

import bpy

from ... import compat
from .tree import Tree, add_socket, group_inputs, node_group, set_outputs

#: Modifier that this module owns on a Curves object.
MODIFIER = "Stormfield Growth"
#: Seconds by which a point counts as reached: far less than a frame, more than single precision loses in half an hour.
SLACK = 1e-4


def show_growing(curves: bpy.types.Object, tail: float) -> None:
    """Show what lies between now and `tail` seconds before (0: everything since the start)."""
    modifier = _modifier(curves, grow_group())
    compat.set_modifier_input(modifier, _identifier(modifier, "Tail"), tail)


def show_by_frame(curves: bpy.types.Object, first: int, last: int) -> None:
    """Show the curves of the current frame; before the first and after the last frame those of that one."""
    modifier = _modifier(curves, frames_group())
    for name, value in (("First", first), ("Last", last)):
        compat.set_modifier_input(modifier, _identifier(modifier, name), value)


@node_group("Stormfield Grow with Time", "GeometryNodeTree")
def grow_group(tree: Tree) -> None:
    """Deletes points whose time is still to come, and those older than the tail."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    add_socket(tree, "Tail", "NodeSocketFloat")
    given = group_inputs(tree)
    age = tree.scene_time("Seconds") - tree.named_attribute("time", "FLOAT")
    to_come = tree.math("LESS_THAN", age, -SLACK)
    old = tree.math("GREATER_THAN", age, given["Tail"] + SLACK)
    has_tail = tree.math("GREATER_THAN", given["Tail"], 0.0)
    hidden = tree.math("MAXIMUM", to_come, old * has_tail)
    set_outputs(tree, geometry=tree.without(given["Geometry"], "POINT", hidden))


@node_group("Stormfield Show by Frame", "GeometryNodeTree")
def frames_group(tree: Tree) -> None:
    """Deletes the curves of other frames."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    for name in ("First", "Last"):
        add_socket(tree, name, "NodeSocketInt")
    given = group_inputs(tree)
    now = tree.math("FLOOR", tree.scene_time("Frame"))
    shown = tree.math("MINIMUM", tree.math("MAXIMUM", now, given["First"]), given["Last"])
    away = tree.math("ABSOLUTE", tree.named_attribute("frame", "INT") - shown)
    hidden = tree.math("GREATER_THAN", away, 0.5)
    set_outputs(tree, geometry=tree.without(given["Geometry"], "CURVE", hidden))


def _modifier(curves: bpy.types.Object, group: bpy.types.NodeTree) -> bpy.types.NodesModifier:
    modifier: Any = curves.modifiers.get(MODIFIER) or curves.modifiers.new(MODIFIER, "NODES")
    if modifier.node_group != group:
        modifier.node_group = group
    return modifier


def _identifier(modifier: bpy.types.NodesModifier, name: str) -> str:
    return next(item.identifier for item in modifier.node_group.interface.items_tree if item.name == name)
