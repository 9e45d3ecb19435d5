# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a mesh a field, take it away, and key λ over the scene's frames."""

import bpy
from bpy.props import BoolProperty

from .. import compat
from ..scene.read import user_preferences
from ..scene.read.active_field import active_field
from ..scene.read.lambda_source import driver_of
from ..scene.write import analysis_objects, attach, timeline
from ..scene.write.lambda_keys import key_lambda_over_scene
from .shared import FieldOperator


class STORMFIELD_OT_add_field(bpy.types.Operator):
    """Design a flow on the active mesh; its time (λ) is keyed from 0 to 1 over the scene's frames"""

    bl_idname = "stormfield.add_field"
    bl_label = "Add Field"
    bl_options = {"REGISTER", "UNDO"}

    key_lambda: BoolProperty(
        name="Key Time",
        description="Key the time along the design (λ) from 0 at the first frame of the scene to 1 at the last",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        obj = context.object
        if obj is None or obj.type != "MESH":
            cls.poll_message_set("Select a mesh: the field lives on its surface")
        elif obj.stormfield.enabled:
            cls.poll_message_set(f"'{obj.name}' has a field already")
        elif not obj.data.polygons and obj.modifiers:
            cls.poll_message_set(
                f"The faces of '{obj.name}' are made by its modifiers; make them its own: Object, Convert, Mesh"
            )
        elif not obj.data.polygons:
            cls.poll_message_set(f"'{obj.name}' has no faces; a field needs a surface")
        elif not obj.is_editable or obj.library:
            cls.poll_message_set(f"'{obj.name}' is linked from another file; make it local first")
        else:
            return True
        return False

    def execute(self, context):
        obj = context.object
        obj.stormfield.enabled = True
        obj.stormfield.solve.samples = user_preferences.read().samples
        if self.key_lambda and compat.find_fcurve(obj, "stormfield.lam") is None:
            key_lambda_over_scene(context.scene, obj)
        self.report({"INFO"}, f"'{obj.name}' has a field now; add elements to shape its flow")
        return {"FINISHED"}


class STORMFIELD_OT_remove_field(FieldOperator, bpy.types.Operator):
    """Take the field away from the mesh: its elements, analysis and settings. Curves, empties and caches stay"""

    bl_idname = "stormfield.remove_field"
    bl_label = "Remove Field"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        obj = active_field(context)
        attach.detach(obj)
        timeline.remove_markers(obj)
        analysis_objects.forget(obj)
        for curve in [c for c in compat.fcurves(obj) if c.data_path.startswith("stormfield.")]:
            compat.remove_fcurve(obj, curve)
        obj.property_unset("stormfield")
        obj.stormfield.enabled = False
        self.report({"INFO"}, f"'{obj.name}' has no field any more; its curves and caches were kept")
        return {"FINISHED"}


class STORMFIELD_OT_key_lambda(FieldOperator, bpy.types.Operator):
    """Key the time along the design (λ) from 0 at the scene's first frame to 1 at its last; shape its F-curve freely"""

    bl_idname = "stormfield.key_lambda"
    bl_label = "Key Time over Scene"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if driver_of(active_field(context)) is not None:
            cls.poll_message_set("λ has a driver, which would win over keys; delete it first (right-click on λ)")
            return False
        return True

    def execute(self, context):
        key_lambda_over_scene(context.scene, active_field(context))
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_add_field, STORMFIELD_OT_remove_field, STORMFIELD_OT_key_lambda)
