# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of edits: take one out, change the order. Solve applies it."""

import bpy
from bpy.props import EnumProperty

from ..scene.read.active_field import active_field
from .shared import FieldOperator


class EditListOperator(FieldOperator):
    """Mix-in of operators on the active edit of the list."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if active_field(context).stormfield.chosen_edit() is None:
            cls.poll_message_set("Choose an edit in the list first")
            return False
        return True


class STORMFIELD_OT_remove_edit(EditListOperator, bpy.types.Operator):
    """Take the active edit out of the list; solve again to have the field without it"""

    bl_idname = "stormfield.remove_edit"
    bl_label = "Remove Edit"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        field = active_field(context).stormfield
        field.edits.remove(field.active_edit)
        field.active_edit = max(0, min(field.active_edit, len(field.edits) - 1))
        return {"FINISHED"}


class STORMFIELD_OT_move_edit(EditListOperator, bpy.types.Operator):
    """Move the active edit in the list; edits are applied from top to bottom at the next solve"""

    bl_idname = "stormfield.move_edit"
    bl_label = "Move Edit"
    bl_options = {"REGISTER", "UNDO"}

    direction: EnumProperty(items=(("UP", "Up", "Towards the top"), ("DOWN", "Down", "Towards the bottom")))

    def execute(self, context):
        field = active_field(context).stormfield
        goal = field.active_edit + (-1 if self.direction == "UP" else 1)
        if not 0 <= goal < len(field.edits):
            return {"CANCELLED"}
        field.edits.move(field.active_edit, goal)
        field.active_edit = goal
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_remove_edit, STORMFIELD_OT_move_edit)
