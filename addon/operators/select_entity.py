# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose an entity: from a list, from the view (a click on its marker), and go to where and when it is."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty
from mathutils import Vector

from ..properties.analysis import LISTS
from ..scene.read.active_field import active_field
from ..scene.read.lambda_seen import passages
from ..scene.read.lambda_source import varies
from ..scene.read.results import EVENT_KINDS
from ..scene.write import selection
from .shared import FieldOperator


class STORMFIELD_OT_select_entity(FieldOperator, bpy.types.Operator):
    """Select this entity in the list, the graph and the 3D view"""

    bl_idname = "stormfield.select_entity"
    bl_label = "Select Entity"
    bl_options = {"UNDO", "INTERNAL"}

    which: EnumProperty(name="List", description="The analysis it belongs to", items=LISTS)
    extend: BoolProperty(name="Extend", description="Keep the active entity selected as well", options={"SKIP_SAVE"})
    index: IntProperty(name="Entity", description="Its place in the list (count); -1 selects none", min=-1)

    def execute(self, context):
        obj = active_field(context)
        if self.index >= len(obj.stormfield.analysis.list(self.which).items):
            self.report({"WARNING"}, f"There is no entity {self.index}; analyze again")
            return {"CANCELLED"}
        (selection.extend if self.extend else selection.select)(obj, self.which, self.index)
        return {"FINISHED"}


class STORMFIELD_OT_go_to_entity(FieldOperator, bpy.types.Operator):
    """Turn the view to the selected entity, and go to the frame where it is; for a bifurcation, where it happens"""

    bl_idname = "stormfield.go_to_entity"
    bl_label = "Go to Entity"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        analysis = active_field(context).stormfield.analysis
        if analysis.list(analysis.shown).selected() is None:
            cls.poll_message_set("Select an entity in the list first")
            return False
        return True

    def execute(self, context):
        obj = active_field(context)
        analysis = obj.stormfield.analysis
        item = analysis.list(analysis.shown).selected()
        frame = self._frame(context, obj, analysis, item)
        if frame is not None:
            context.scene.frame_set(frame)
        place = obj.matrix_world @ Vector(item.position)
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                _turn_to(area.spaces.active.region_3d, obj, place)
        return {"FINISHED"}

    def _frame(self, context, obj, analysis, item) -> int | None:
        """The nearest frame where λ is right; None to stay."""
        if analysis.shown == "history":
            lam = item.lam if item.kind in EVENT_KINDS else 0.5 * (item.lam_start + item.lam_end)
            if item.kind not in EVENT_KINDS and item.lam_start <= obj.stormfield.lam <= item.lam_end:
                return None
        else:
            lam = analysis.list(analysis.shown).lam
        places = passages(context, obj, [lam])[0]
        if not places:
            if not varies(obj):
                obj.stormfield.lam = lam
            return None
        return min((frame for frame, _forward in places), key=lambda frame: abs(frame - context.scene.frame_current))


def _turn_to(view: bpy.types.RegionView3D, obj: bpy.types.Object, place: Vector) -> None:
    """Look at the place from outside, from as far as before."""
    middle = obj.matrix_world @ (sum((Vector(corner) for corner in obj.bound_box), Vector()) / 8)
    outward = place - middle
    if outward.length > 0:
        view.view_rotation = outward.to_track_quat("Z", "Y")
    view.view_location = middle


CLASSES = (STORMFIELD_OT_select_entity, STORMFIELD_OT_go_to_entity)
