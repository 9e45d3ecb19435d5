# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier that turns the field with the surface that is seen: there as soon as something moves the surface.

It stays behind all other modifiers. Renders need no Python.
"""

from typing import Any

import bpy

from ... import compat
from ..nodes.turning import KEEP_SPEED, turn_group
from ..read.attached import LAMBDA, NAMES, TURN

#: Kinds of parents that bend what they carry.
BENDING_PARENTS = frozenset({"ARMATURE", "LATTICE", "CURVE"})


def follow_surface(obj: bpy.types.Object) -> None:
    """Add the modifier where the object's surface is not its own mesh, and it is not there yet."""
    if TURN in obj.modifiers or LAMBDA not in obj.modifiers or not is_changed(obj):
        return
    modifier: Any = obj.modifiers.new(TURN, "NODES")
    modifier.node_group = turn_group()
    modifier.use_pin_to_last = True
    modifier.show_expanded = False
    modifier.show_viewport = obj.modifiers[LAMBDA].show_viewport
    modifier.show_render = obj.modifiers[LAMBDA].show_render
    obj.add_rest_position_attribute = True
    set_speed(obj)


def is_changed(obj: bpy.types.Object) -> bool:
    """Whether shape keys, modifiers or a parent may change the surface that is seen."""
    own = {*NAMES, TURN}
    return (
        obj.data.shape_keys is not None
        or any(modifier.name not in own for modifier in obj.modifiers)
        or (obj.parent is not None and obj.parent_type in BENDING_PARENTS)
    )


def set_speed(obj: bpy.types.Object) -> None:
    """Bring the setting of the field to the modifier."""
    modifier = obj.modifiers.get(TURN)
    if modifier is None:
        return
    items = modifier.node_group.interface.items_tree
    identifier = next(item.identifier for item in items if item.name == KEEP_SPEED)
    compat.set_modifier_input(modifier, identifier, 1.0 if obj.stormfield.speed_on == "WORLD" else 0.0)
    obj.update_tag()
