# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of edits: take one out, change the order. Solve applies it."""

import bpy
from bpy.props import EnumProperty

from ..model.design import Design
from ..scene.read.active_field import active_field
from ..scene.read.current_field import is_given, why_no_field
from ..scene.read.edits import read_edits
from ..scene.read.mesh import read_mesh
from . import requirements
from .edit_operator import given_solves, show_given
from .job_operator import JobOperator
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
        for place in (field.active_edit, goal):
            field.edits[place].status = field.edits[place].reason = ""  # they wait
        field.edits.move(field.active_edit, goal)
        field.active_edit = goal
        return {"FINISHED"}


class STORMFIELD_OT_apply_edits(JobOperator, bpy.types.Operator):
    """Apply the list to a field that was imported or comes from an attribute, as it was given. Esc stops"""

    bl_idname = "stormfield.apply_edits"
    bl_label = "Apply Edits"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Editing"

    @staticmethod
    def why_not(obj):
        if not is_given(obj):
            return "Solve applies the edits of a field that was solved here"
        return requirements.problem() or why_no_field(obj)

    def start(self, context, obj):
        mesh, edits = read_mesh(obj), read_edits(context, obj)
        return given_solves(obj, mesh)(Design((), edits=edits))

    def finish(self, _context, obj, result):
        show_given(obj, result)
        refused = sum(edit.enabled and edit.status == "refused" for edit in obj.stormfield.edits)
        self.report({"WARNING" if refused else "INFO"}, f"'{obj.name}' has its edits, {refused} refused")


CLASSES = (STORMFIELD_OT_apply_edits, STORMFIELD_OT_remove_edit, STORMFIELD_OT_move_edit)
