# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier that turns the field with the surface that is seen: there as soon as something moves the surface.

It stays behind all other modifiers. Renders need no Python.
"""

from typing import Any

import bpy

from ... import compat
from ..nodes.turning import KEEP_SPEED, turn_group
from ..read.attached import LAMBDA, SORT, TURN, find_modifier
from ..read.seen_surface import is_changed
from .following import let_all_follow


def follow_surface(obj: bpy.types.Object) -> None:
    """Add the modifier where the object's surface is not its own mesh, and it is not there yet."""
    field = find_modifier(obj, LAMBDA)
    if field is None or find_modifier(obj, TURN) is not None or not is_changed(obj):
        return
    modifier: Any = obj.modifiers.new(TURN, "NODES")
    modifier.node_group = turn_group()
    modifier.node_group[SORT] = TURN
    modifier.use_pin_to_last = True
    modifier.show_expanded = False
    modifier.show_viewport, modifier.show_render = field.show_viewport, field.show_render
    obj.add_rest_position_attribute = True
    set_speed(obj)
    let_all_follow(obj)


def set_speed(obj: bpy.types.Object) -> None:
    """Bring the setting of the field to the modifier."""
    modifier = find_modifier(obj, TURN)
    if modifier is None:
        return
    items = modifier.node_group.interface.items_tree
    identifier = next(item.identifier for item in items if item.name == KEEP_SPEED)
    compat.set_modifier_input(modifier, identifier, 1.0 if obj.stormfield.speed_on == "WORLD" else 0.0)
    obj.update_tag()
