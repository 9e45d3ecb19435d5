# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier of curves and points that were made on a mesh at rest: they follow the surface that is seen. Renders
need no Python."""

from typing import Any

import bpy

from ... import compat
from ..nodes.following import FACES, SURFACE, follow_group
from ..read.attached import SORT, TURN, find_modifier
from ..read.results import ROLE
from ..read.seen_surface import is_changed

FOLLOW = "Stormfield Follow"
#: Modifiers that put copies behind the mesh itself, and those that make other faces of it.
COPYING = frozenset({"ARRAY", "MIRROR"})
# fmt: off
REFINING = frozenset({
    "SUBSURF", "MULTIRES", "BEVEL", "BOOLEAN", "BUILD", "DECIMATE", "EDGE_SPLIT",
    "MASK", "NODES", "REMESH", "SCREW", "SKIN", "SOLIDIFY", "TRIANGULATE",
    "VOLUME_TO_MESH", "WELD", "WIREFRAME",
})
# fmt: on


def follow_surface(made: bpy.types.Object) -> None:
    """Let an object follow the surface of its parent, where that is not the parent's own mesh."""
    surface = made.parent
    if surface is None or surface.type != "MESH" or not surface.is_editable or not is_changed(surface):
        return
    modifier: Any = _modifier(made)
    if modifier is None:
        modifier = made.modifiers.new(FOLLOW, "NODES")
        modifier.node_group = follow_group()
        modifier.node_group[SORT] = FOLLOW
        modifier.show_expanded = False
        made.modifiers.move(len(made.modifiers) - 1, 0)
    inputs = {item.name: item.identifier for item in modifier.node_group.interface.items_tree}
    compat.set_modifier_input(modifier, inputs[SURFACE], surface)
    compat.set_modifier_input(modifier, inputs[FACES], _own_faces(surface))
    surface.add_rest_position_attribute = True
    made.update_tag()


def let_all_follow(surface: bpy.types.Object) -> None:
    """All that was made on a surface, when something begins to move it."""
    for made in surface.children:
        if made.get(ROLE) is not None:
            follow_surface(made)


def _modifier(made: bpy.types.Object) -> bpy.types.Modifier | None:
    groups = ((modifier, modifier.node_group) for modifier in made.modifiers if modifier.type == "NODES")
    return next((modifier for modifier, group in groups if group is not None and group.get(SORT) == FOLLOW), None)


def _own_faces(surface: bpy.types.Object) -> int:
    """How many of the first faces that are seen are the mesh itself; 0 where there are no others."""
    turn = find_modifier(surface, TURN)
    types = {modifier.type for modifier in surface.modifiers if modifier != turn}
    return len(surface.data.polygons) if types & COPYING and not types & REFINING else 0
