# SPDX-License-Identifier: GPL-3.0-or-later
"""The Analysis panel: what the field does now and over λ, in lists to filter and select in; and curves made of it."""

import bpy

from ..operators.analyze import STORMFIELD_OT_analyze
from ..operators.analyze_lambda import STORMFIELD_OT_analyze_lambda
from ..operators.pathlines import STORMFIELD_OT_pathlines
from ..operators.streamlines import STORMFIELD_OT_streamlines
from ..properties.analysis import CATEGORIES
from ..scene.nodes import entity_nodes
from ..scene.read.active_field import active_field
from . import graph_editor
from .entity_details import draw_entity
from .panel_parts import FieldPanel, draw_progress, hint, text_lines

#: What stands in place of an empty list.
EMPTY = {
    "ecg": "Analyze at this Frame finds where flow comes from, turns and ends",
    "history": "Follow over Time (λ) finds where storms appear, meet and vanish",
    "mcg": "Find Regions divides the surface; see the panel Flow Regions below",
}


class STORMFIELD_PT_analysis(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_analysis"
    bl_label = "Analysis"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        obj = active_field(context)
        analysis = obj.stormfield.analysis
        if not draw_progress(layout, STORMFIELD_OT_analyze.job_title, STORMFIELD_OT_analyze_lambda.job_title):
            column = layout.column(align=True)
            column.scale_y = 1.2
            column.operator("stormfield.analyze", icon="VIEWZOOM")
            column.operator("stormfield.analyze_lambda", icon="FCURVE")
            hint(context, layout, STORMFIELD_OT_analyze.why_not(obj) or STORMFIELD_OT_analyze_lambda.why_not(obj))
        layout.row(align=True).prop(analysis, "shown", expand=True)
        entities = analysis.list(analysis.shown)
        if analysis.shown == "history":
            row = layout.row()
            row.use_property_split, row.use_property_decorate = True, False
            row.prop(analysis, "persistence", slider=True)
        if not entities.made:
            text_lines(context, layout, EMPTY[analysis.shown], icon="INFO")
            return
        row = layout.row()
        row.template_list("STORMFIELD_UL_entities", analysis.shown, entities, "items", entities, "active", rows=6)
        column = row.column(align=True)
        column.operator("stormfield.go_to_entity", text="", icon="ZOOM_SELECTED")
        column.operator("stormfield.show_graph", text="", icon="NODETREE")
        if analysis.shown == "history":
            column.operator("stormfield.update_markers", text="", icon="MARKER_HLT")
        column.separator()
        column.operator("stormfield.forget_analysis", text="", icon="X")
        if analysis.shown != "mcg":
            row = layout.row()
            row.prop(analysis, "detail", slider=True)
            weak = entities.weak()
            if weak:
                layout.label(text=f"{weak} weak one{'s' if weak != 1 else ''} hidden", icon="HIDE_ON")
        draw_entity(context, layout, obj, analysis.shown)
        _draw_filters(layout, entities, analysis.shown)


class STORMFIELD_PT_curves(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_curves"
    bl_parent_id = "STORMFIELD_PT_analysis"
    bl_label = "Curves"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context):
        if draw_progress(self.layout, *(maker.job_title for maker, _icon in CURVES)):
            return
        column = self.layout.column(align=True)
        for maker, icon in CURVES:
            column.operator(maker.bl_idname, icon=icon)


class STORMFIELD_PT_look_analysis(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_look_analysis"
    bl_parent_id = "STORMFIELD_PT_look"
    bl_label = "Analysis"

    def draw_header(self, context):
        self.layout.prop(active_field(context).stormfield.analysis, "show", text="")

    def draw(self, context):
        layout = self.settings_layout()
        field = active_field(context).stormfield
        analysis = field.analysis
        layout.active = analysis.show and field.look.show_overlay
        column = layout.column(heading="Draw")
        for name in ("show_separatrices", "show_orbits", "show_paths", "show_sets", "show_names"):
            column.prop(analysis, name)
        column = layout.column()
        column.prop(analysis, "width")
        column.prop(analysis, "opacity", slider=True)


#: Operators that make curves for hair and curve shading.
CURVES = ((STORMFIELD_OT_streamlines, "OUTLINER_OB_CURVES"), (STORMFIELD_OT_pathlines, "TRACKING"))


def _draw_filters(layout, entities, which: str) -> None:
    header, body = layout.panel(f"stormfield_filters_{which}", default_closed=True)
    shown = sum(entities.passes(item) for item in entities.items)
    header.label(text=f"Filter: {shown} of {len(entities.items)} shown")
    if body is None:
        return
    body.use_property_split = True
    body.use_property_decorate = False
    column = body.column()
    grid = column.grid_flow(columns=2, align=True)
    grid.use_property_split = False
    for key, *_ in CATEGORIES:
        if key not in {"EVENT", "CHANGE"} or which == "history":
            grid.prop_enum(entities, "kinds", key)
    column.prop(entities, "min_strength", slider=True)
    if which == "history":
        column.prop(entities, "min_life", slider=True)


class STORMFIELD_OT_show_graph(bpy.types.Operator):
    """Show the graph of the entities in an editor below the 3D view"""

    bl_idname = "stormfield.show_graph"
    bl_label = "Show Graph"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        obj = active_field(context)
        analysis = obj.stormfield.analysis if obj is not None else None
        if analysis is None or not (analysis.ecg_tree or analysis.mcg_tree):
            cls.poll_message_set("There is no graph yet: Analyze at this Frame, or Find Regions")
            return False
        if context.area is None or context.screen.show_fullscreen:
            cls.poll_message_set("Needs a window with more than one editor; leave full screen")
            return False
        return True

    def execute(self, context):
        area = next((a for a in context.screen.areas if a.ui_type == entity_nodes.TREE), None)
        if area is None:
            before = set(context.screen.areas)
            bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.36)
            area = next(iter(set(context.screen.areas) - before))
            area.ui_type = entity_nodes.TREE
            _settle(area)
        graph_editor.frame_soon()
        return {"FINISHED"}


def _settle(area: bpy.types.Area) -> None:
    space = area.spaces.active
    space.show_region_toolbar = space.show_region_ui = False
    space.overlay.show_context_path = False


CLASSES = (STORMFIELD_PT_analysis, STORMFIELD_PT_curves, STORMFIELD_OT_show_graph)
#: Inside the Look panel, which must be there first.
LATER = (STORMFIELD_PT_look_analysis,)
