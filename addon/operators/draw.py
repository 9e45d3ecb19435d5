# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw elements on the surface with Blender's own Draw tool: set it up, and come back from it."""

import bpy
from bpy.props import EnumProperty

from ..properties.element import TYPES
from ..scene.read.active_field import active_field
from ..scene.write import merge
from ..scene.write.elements import add_element
from .elements import PRESET_ITEMS, PRESETS
from .shared import FieldOperator

#: How far above the surface strokes are drawn, over the object's diagonal.
ABOVE = 0.004


def diagonal(obj: bpy.types.Object) -> float:
    """In world space, as strokes are drawn."""
    return sum(size**2 for size in obj.dimensions) ** 0.5


class STORMFIELD_OT_draw_element(FieldOperator, bpy.types.Operator):
    """Draw on the surface: every stroke becomes a curve of one new element. Finish with Tab or Finish Drawing"""

    bl_idname = "stormfield.draw_element"
    bl_label = "Draw on Surface"
    bl_options = {"REGISTER", "UNDO"}

    type: EnumProperty(name="Type", description="What the strokes mean", items=TYPES, default="streamline")
    preset: EnumProperty(
        name="Preset",
        description="What the strokes mean, by an example; it goes before the type",
        items=(("NONE", "None", "The type says what they mean"), *PRESET_ITEMS),
    )

    @classmethod
    def description(cls, _context, properties):
        if properties.preset == "NONE":
            return ""
        _label, text, settings = PRESETS[properties.preset]
        if properties.preset == "MERGE":
            return f"{text}. Draw a stroke for each whose ends meet and, at will, one that goes on; then Finish Drawing"
        how = "Draw its path, or one short stroke" if settings["type"] == "singular" else "Draw it on the surface"
        return f"{text}. {how}; every stroke belongs to one new element. Finish with Tab or Finish Drawing"

    def execute(self, context):
        obj = active_field(context)
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        name, settings = self._meaning()
        data = bpy.data.curves.new(name, "CURVE")
        data.dimensions = "3D"
        curve = bpy.data.objects.new(data.name, data)
        curve.parent = obj  # what is drawn is then in the mesh's own space and follows it
        for collection in obj.users_collection or [context.scene.collection]:
            collection.objects.link(curve)
        add_element(obj, curve, **settings)
        if self.preset == "MERGE":
            curve[merge.MARK] = True
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        curve.select_set(True)
        context.view_layer.objects.active = curve
        bpy.ops.object.mode_set(mode="EDIT")
        paint = context.tool_settings.curve_paint_settings
        paint.depth_mode, paint.curve_type = "SURFACE", "BEZIER"
        paint.use_project_only_selected, paint.use_stroke_endpoints = True, False
        # Above the surface all along: a stroke becomes few points, and between them it would sink in.
        paint.surface_offset, paint.error_threshold, paint.radius_max = ABOVE * diagonal(obj), 2, 0.0
        if context.area and context.area.type == "VIEW_3D":
            bpy.ops.wm.tool_set_by_id(name="builtin.draw")
        self.report({"INFO"}, f"Draw on '{obj.name}'; Tab when done")
        return {"FINISHED"}

    def _meaning(self) -> tuple[str, dict[str, object]]:
        """Name and settings of the new element."""
        if self.preset != "NONE":
            label, _text, settings = PRESETS[self.preset]
            return label, settings
        return next(label for key, label, *_ in TYPES if key == self.type), {"type": self.type}


class STORMFIELD_OT_finish_drawing(FieldOperator, bpy.types.Operator):
    """Leave the Draw tool and select the field's mesh again"""

    bl_idname = "stormfield.finish_drawing"
    bl_label = "Finish Drawing"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if context.mode not in {"EDIT_CURVE", "EDIT_CURVES"}:
            cls.poll_message_set("Nothing is being drawn")
            return False
        return super().poll(context)

    def execute(self, context):
        obj, curve = active_field(context), context.object
        if context.area and context.area.type == "VIEW_3D":
            bpy.ops.wm.tool_set_by_id(name="builtin.select_box")
        bpy.ops.object.mode_set(mode="OBJECT")
        curve.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        strokes = len(curve.data.splines) if curve.type == "CURVE" else len(curve.data.curves)
        if strokes == 0:
            self.report({"WARNING"}, f"Nothing was drawn; '{curve.name}' is empty")
        elif curve.get(merge.MARK):
            self._merge(obj, curve)
        return {"FINISHED"}

    def _merge(self, obj, curve):
        """Make storms that merge of the strokes; what cannot be is said, and the strokes stay as they are."""
        element = next((element for element in obj.stormfield.elements if element.source == curve), None)
        reason = merge.why_not(curve)
        if element is None or reason:
            self.report({"WARNING"}, reason or f"'{curve.name}' is no element any more")
            return
        merge.split_into_merge(obj, element)
        self.report({"INFO"}, f"Two storms merge at λ {merge.MEETING:g}; solve to see them")


CLASSES = (STORMFIELD_OT_draw_element, STORMFIELD_OT_finish_drawing)
