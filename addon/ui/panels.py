# SPDX-License-Identifier: GPL-3.0-or-later
"""The Stormfield tab of the 3D view's sidebar, in the order of the work."""

import bpy
from bl_ui.utils import PresetPanel

from .. import compat
from ..model.element_types import RULES
from ..operators import bake, elements, requirements, solve, transfer
from ..scene.read import user_preferences
from ..scene.read.active_field import active_field
from ..scene.read.attached import FRAMES, LAMBDA, TURN, attached_file, find_modifier
from ..scene.read.element_settings import KIND_OF, shown_settings
from ..scene.read.lambda_source import why_sampled
from ..scene.write import mesh_edits
from ..scene.write.cache_folders import stray_folders
from ..session import saves
from . import baked_caches, doubts, out_of_date, pictures
from .panel_parts import FieldPanel, SidebarPanel, job_button, text_lines


class STORMFIELD_PT_presets(PresetPanel, bpy.types.Panel):
    """Solve and bake settings under a name"""

    bl_idname = "STORMFIELD_PT_presets"
    bl_label = "Stormfield Presets"
    preset_subdir = "stormfield"
    preset_operator = "script.execute_preset"
    preset_add_operator = "stormfield.add_preset"


class STORMFIELD_PT_field(SidebarPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_field"
    bl_label = "Field"

    def draw(self, context):
        layout = self.settings_layout()
        problem = requirements.problem()
        if problem:
            box = layout.box()
            box.alert = True
            text_lines(context, box, problem, icon="ERROR")
        obj = active_field(context)
        if context.object is not None and context.object.type == "MESH" and not context.object.stormfield.enabled:
            layout.operator("stormfield.add_field", icon="ADD", text=f"Add Field to {context.object.name}")
            layout.operator("stormfield.field_from_attribute", icon="SPREADSHEET")
        elif obj is None:
            layout.operator("stormfield.add_field", icon="ADD")
            layout.label(text="Select a mesh to begin", icon="INFO")
        if obj is None:
            return
        row = layout.row(align=True)
        row.label(text=obj.name, icon="MESH_DATA")
        if context.object == obj:
            row.operator("stormfield.field_from_attribute", text="", icon="SPREADSHEET")
        row.operator("stormfield.remove_field", text="", icon="X")
        baked_caches.draw_offer(context, layout, obj)
        column = layout.column()
        column.use_property_split = False
        column.use_property_decorate = True
        column.prop(obj.stormfield, "lam", slider=True)
        why = why_sampled(obj)
        if why:
            text_lines(context, layout, f"λ comes from {why}: bakes go through the frames to read it", icon="INFO")
        elif compat.find_fcurve(obj, "stormfield.lam") is None:
            layout.operator("stormfield.key_lambda", icon="KEY_HLT")
        if find_modifier(obj, TURN) is not None:
            layout.prop(obj.stormfield, "speed_on")


class STORMFIELD_PT_elements(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_elements"
    bl_label = "Elements"

    def draw(self, context):
        layout = self.layout
        obj = active_field(context)
        field = obj.stormfield
        if context.mode in {"EDIT_CURVE", "EDIT_CURVES"}:
            row = layout.row()
            row.scale_y = 1.4
            row.operator("stormfield.finish_drawing", icon="CHECKMARK")
        else:
            _draw_presets(layout)
        row = layout.row()
        row.template_list("STORMFIELD_UL_elements", "", field, "elements", field, "active_element", rows=3)
        column = row.column(align=True)
        column.operator("stormfield.remove_element", text="", icon="REMOVE")
        column.menu("STORMFIELD_MT_element_list", text="", icon="DOWNARROW_HLT")
        element = field.active()
        if element is not None:
            _draw_element(context, layout, obj, element)


#: Presets in a row of the panel.
IN_A_ROW = 3
#: Height of a preset's picture, in buttons.
PICTURE_SCALE = 1.1


def _draw_presets(layout):
    """Draw on the surface: one picture for each kind of flow; last, what else may become an element."""
    header, body = layout.panel("stormfield_presets", default_closed=False)
    header.label(text="Draw on Surface", icon="GREASEPENCIL")
    if body is None:
        return
    grid = body.grid_flow(row_major=True, columns=IN_A_ROW, even_columns=True, even_rows=True, align=True)
    for key, (label, _text, _settings) in elements.PRESETS.items():
        cell = grid.column(align=True)
        cell.template_icon(icon_value=pictures.of(key), scale=PICTURE_SCALE)
        cell.operator("stormfield.draw_element", text=label).preset = key
    cell = grid.column(align=True)
    cell.template_icon(icon_value=0, scale=PICTURE_SCALE)
    cell.menu("STORMFIELD_MT_not_drawn", text="Other")


def _draw_element(context, layout, obj, element):
    layout.use_property_split = True
    layout.use_property_decorate = False
    column = layout.column()
    if element.type in KIND_OF:
        column.prop(element, KIND_OF[element.type])
    instant = RULES[element.type].instant
    if instant:
        column.prop(element, "lam_start", text="Happens at")
    elif not element.from_animation:
        times = column.column(align=True)
        times.prop(element, "lam_start")
        times.prop(element, "lam_end")
    keyed = column.column()
    keyed.use_property_decorate = True
    for name in shown_settings(element.type):
        if name != "angle" and not (name == "reverse" and instant and not element.bifurcation_kind.startswith("hopf")):
            keyed.prop(element, name)
    length = user_preferences.length_text(context, element.radius, max(obj.matrix_world.to_scale()))
    if length:
        column.label(text=f"Radius in the scene: {length}")
    header, body = layout.panel("stormfield_element_more", default_closed=True)
    header.label(text="More")
    if body is None:
        return
    body.use_property_split, body.use_property_decorate = True, False
    column = body.column()
    column.prop(element, "type")
    column.prop(element, "source")
    column.prop(element, "field")
    if "angle" in shown_settings(element.type) and (element.type != "singular" or element.kind == "saddle"):
        row = column.row()
        row.use_property_decorate = True
        row.prop(element, "angle")
    if not instant:
        fades = column.column(align=True)
        fades.prop(element, "fade_in")
        fades.prop(element, "fade_out")
        column.prop(element, "from_animation")
    if element.type != "brush":
        column.prop(element, "hard")


class STORMFIELD_PT_solve(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_solve"
    bl_label = "Solve"

    def draw_header_preset(self, context):
        if context.object == active_field(context):
            STORMFIELD_PT_presets.draw_panel_header(self.layout)

    def draw(self, context):
        layout = self.settings_layout()
        obj = active_field(context)
        settings = obj.stormfield.solve
        job_button(context, layout, solve.STORMFIELD_OT_solve, obj, icon="PLAY")
        out_of_date.draw_in_panel(context, layout, obj)
        if mesh_edits.is_paused(obj):
            job_button(context, layout, transfer.STORMFIELD_OT_transfer_field, obj, icon="MOD_DATA_TRANSFER")
        doubts.draw(context, layout, obj)
        _draw_solve_settings(layout, settings)
        if stray_folders(obj):
            sentences = saves.refused() or ("Caches of this object do not lie beside the file.",)
            for sentence in sentences:
                text_lines(context, layout, sentence, icon="ERROR")
            layout.operator("stormfield.bring_caches", icon="FILE_REFRESH")
        file = attached_file(obj, LAMBDA)
        if file is not None and not file.exists():
            text_lines(context, layout, f"The λ cache is missing: {file.parent}. Solve again", icon="ERROR")


def _draw_solve_settings(layout, settings):
    header, body = layout.panel("stormfield_solve_settings", default_closed=True)
    header.label(text="Settings")
    if body is None:
        return
    body.use_property_split, body.use_property_decorate = True, False
    column = body.column()
    column.prop(settings, "even_speed", slider=True)
    column.prop(settings, "lambda_weight")
    column.prop(settings, "samples")
    column.prop(settings, "tolerance")
    column.prop(settings, "solve_on")
    if settings.solve_on == "DENSITY":
        column.prop(settings, "edge")
    column.prop(settings, "border")
    column.prop(settings, "weld")
    column.prop(settings, "keep_solver")


class STORMFIELD_PT_bake(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_bake"
    bl_label = "Bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.settings_layout()
        obj = active_field(context)
        settings = obj.stormfield.bake
        job_button(context, layout, bake.STORMFIELD_OT_bake, obj, icon="RENDER_ANIMATION")
        column = layout.column(heading="Write")
        column.prop(settings, "use_frames")
        if settings.use_frames:
            column.prop(settings, "period")
            column.prop(settings, "speed")
        column.prop(settings, "use_exr")
        if settings.use_exr:
            column.prop_search(settings, "uv_layer", obj.data, "uv_layers", icon="GROUP_UVS")
            column.prop(settings, "resolution")
        column.prop(settings, "use_vdb")
        if settings.use_vdb:
            column.prop(settings, "voxel_size")
        column.prop(settings, "use_morse")
        column.prop(settings, "use_scene_frames")
        if not settings.use_scene_frames:
            frames = column.column(align=True)
            frames.prop(settings, "frame_start")
            frames.prop(settings, "frame_end", text="End")
        layout.prop(settings, "folder")
        layout.operator("stormfield.use_baked_caches", icon="FILE_REFRESH")
        layout.operator("stormfield.clean_caches", icon="TRASH")


class STORMFIELD_PT_shading(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_shading"
    bl_label = "Shading"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        obj = active_field(context)
        material = obj.active_material
        layout.operator_menu_enum("stormfield.apply_material", "material", icon="MATERIAL")
        layout.operator("stormfield.material_from_image", text="From Image", icon="IMAGE_DATA")
        if material is not None:
            layout.label(text=material.name, icon="MATERIAL_DATA")
        if find_modifier(obj, FRAMES) is None:
            text_lines(context, layout, "Bake the flowing texture to see these materials move", icon="INFO")


class STORMFIELD_PT_look(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_look"
    bl_label = "Look"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(active_field(context).stormfield.look, "show_overlay", text="")

    def draw(self, context):
        layout = self.settings_layout()
        look = active_field(context).stormfield.look
        layout.active = look.show_overlay
        column = layout.column()
        column.prop(look, "shown_field")
        column.prop(look, "style")
        if look.style != "NONE":
            column.prop(look, "spacing")
            column.prop(look, "length")
            column.prop(look, "width")
            column.prop(look, "opacity", slider=True)
            column.prop(look, "show_motion")
        column = layout.column(heading="Mark")
        column.prop(look, "show_elements")
        column.prop(look, "show_fixed_points")
        column.prop(look, "show_legend")


CLASSES = (
    STORMFIELD_PT_presets,
    STORMFIELD_PT_field,
    STORMFIELD_PT_elements,
    STORMFIELD_PT_solve,
    STORMFIELD_PT_look,
    STORMFIELD_PT_shading,
    STORMFIELD_PT_bake,
)
