# SPDX-License-Identifier: GPL-3.0-or-later
"""The Edits panel, inside Analysis: cancel what the analysis shows, and the list of what was done."""

import bpy

from ..operators.edit_choice import why_not_cancel
from ..operators.edits import EditOperator
from ..scene.read.active_field import active_field
from .panel_parts import FieldPanel, draw_progress, hint, text_lines

#: What became of an edit, before the reason why it was not done, or not all of it.
WORDS = {"refused": "Refused", "applied": "Applied in part"}


class STORMFIELD_PT_edits(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_edits"
    bl_parent_id = "STORMFIELD_PT_analysis"
    bl_label = "Edits"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        obj = active_field(context)
        if not draw_progress(layout, EditOperator.job_title):
            column = layout.column(align=True)
            column.operator("stormfield.cancel_pair", icon="TRASH")
            column.operator("stormfield.cancel_weakest", icon="REMOVE")
            column.operator("stormfield.simplify", icon="MOD_DECIM")
            hint(context, layout, why_not_cancel(obj))
        field = obj.stormfield
        if not field.edits:
            return
        row = layout.row()
        row.template_list("STORMFIELD_UL_edits", "", field, "edits", field, "active_edit", rows=3)
        column = row.column(align=True)
        column.operator("stormfield.remove_edit", text="", icon="REMOVE")
        column.separator()
        column.operator("stormfield.move_edit", text="", icon="TRIA_UP").direction = "UP"
        column.operator("stormfield.move_edit", text="", icon="TRIA_DOWN").direction = "DOWN"
        edit = field.chosen_edit()
        if edit is not None:
            _draw_edit(context, self.settings_layout(), edit)


def _draw_edit(context, layout, edit) -> None:
    """What can be set of an edit, and why it was refused."""
    if edit.enabled and edit.reason:
        text_lines(context, layout, f"{WORDS.get(edit.status, 'Refused')}: {edit.reason}", icon="ERROR")
    column = layout.column()
    if edit.type == "simplify":
        column.prop(edit, "keep")
    column.prop(edit, "lam", slider=True)
    column.prop(edit, "reach", slider=True)
    column.prop(edit, "field")


CLASSES = (STORMFIELD_PT_edits,)
