# SPDX-License-Identifier: GPL-3.0-or-later
"""The Edits panel, inside Analysis: change what the analysis shows, and the list of what was done."""

import bpy

from ..operators.edit_choice import edits_differ, picked, why_not_cancel, why_not_region
from ..operators.edit_operator import EditOperator
from ..scene.read.active_field import active_field
from ..scene.read.current_field import is_given
from ..session import edit_preview
from .panel_parts import FieldPanel, draw_progress, hint, text_lines

#: What became of an edit, before the reason why it was not done, or not all of it.
WORDS = {"refused": "Refused", "applied": "Applied in part"}
WAITING = "It waits to be applied"


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
            column.operator("stormfield.move_point", icon="EMPTY_ARROWS")
            _draw_simplify(context, layout.column(align=True), obj)
            column = layout.column(align=True)
            column.operator("stormfield.smooth_region", icon="MOD_SMOOTH")
            column.operator("stormfield.transform_field", icon="ORIENTATION_GIMBAL")
            hint(context, layout, why_not_region(obj) or why_not_cancel(obj) or _why_not_pair(obj))
            layout.prop(obj.stormfield.analysis, "show_partners")
        field = obj.stormfield
        if not field.edits:
            return
        if is_given(obj):
            row = layout.row()
            row.active = edits_differ(obj)
            row.operator("stormfield.apply_edits", icon="CHECKMARK")
        row = layout.row()
        row.template_list("STORMFIELD_UL_edits", "", field, "edits", field, "active_edit", rows=3)
        column = row.column(align=True)
        column.operator("stormfield.remove_edit", text="", icon="REMOVE")
        column.separator()
        column.operator("stormfield.move_edit", text="", icon="TRIA_UP").direction = "UP"
        column.operator("stormfield.move_edit", text="", icon="TRIA_DOWN").direction = "DOWN"
        edit = field.chosen_edit()
        if edit is not None:
            _draw_edit(context, self.settings_layout(), obj, edit)


def _draw_simplify(context, column, obj) -> None:
    analysis = obj.stormfield.analysis
    row = column.row(align=True)
    row.operator("stormfield.simplify", icon="MOD_DECIM").keep = analysis.keep
    row.prop(analysis, "preview_simplify", text="", icon="HIDE_OFF" if analysis.preview_simplify else "HIDE_ON")
    column.prop(analysis, "keep", slider=True)
    simpler = edit_preview.simpler(obj)
    if simpler is not None:
        count = f"{len(analysis.ecg.items)} entities become {simpler.count}"
        text_lines(context, column, count, icon="INFO" if simpler.count <= simpler.keep else "ERROR")
    elif edit_preview.is_busy(obj):
        column.label(text="Looking what would be left…", icon="TIME")


def _why_not_pair(obj) -> str:
    """What must remain of the two that are selected, as the core says."""
    chosen, active = picked(obj), obj.stormfield.analysis.ecg.active
    if len(chosen) != 2 or active not in chosen:
        return ""
    partner = edit_preview.partners(obj).get(next(index for index in chosen if index != active))
    if partner is None:
        return ""
    return partner.reason or f"Leaves {partner.left}"


def _draw_edit(context, layout, obj, edit) -> None:
    """What can be set of an edit, and why it was refused."""
    if edit.enabled and edit.reason:
        text_lines(context, layout, f"{WORDS.get(edit.status, 'Refused')}: {edit.reason}", icon="ERROR")
    elif edit.enabled and not edit.status:
        text_lines(context, layout, WAITING, icon="TIME")
    column = layout.column()
    if edit.type == "simplify":
        column.prop(edit, "keep")
    if edit.type == "move":
        column.prop(edit, "to")
    if edit.type == "transform":
        _draw_transform(layout.column(), edit)
    if edit.type in {"smooth", "transform"}:
        _draw_region(layout.column(), obj, edit)
    column = layout.column(align=True)
    column.prop(edit, "lam", slider=True)
    if edit.type in {"smooth", "transform"}:
        column.prop(edit, "lam_end", slider=True)
    if edit.type != "transform":
        column.prop(edit, "reach", slider=True)
    layout.prop(edit, "field")


def _draw_transform(column, edit) -> None:
    column.use_property_decorate = True  # they may have keys
    column.prop(edit, "angle")
    column.prop(edit, "scale")
    column.prop(edit, "stretch")
    column.use_property_decorate = False
    if edit.stretch != 1.0:
        column.prop(edit, "axis")
        if edit.axis == "CURVE":
            column.prop(edit, "axis_curve")
    column.prop(edit, "frozen")


def _draw_region(column, obj, edit) -> None:
    column.prop(edit, "region")
    match edit.region:
        case "DISC":
            column.prop(edit, "center")
            column.prop(edit, "radius")
        case "LOOP":
            column.prop(edit, "loop")
        case "FACES":
            column.prop_search(edit, "faces", obj.data, "attributes")
        case "GROUP":
            column.prop_search(edit, "faces", obj, "vertex_groups", text="Group")
    if edit.type == "transform" and edit.region != "ALL":
        column.prop(edit, "falloff")


CLASSES = (STORMFIELD_PT_edits,)
