# SPDX-License-Identifier: GPL-3.0-or-later
"""Give the field's mesh one of the flowing materials."""

import bpy
from bpy.props import EnumProperty

from .. import shading
from ..scene.read.active_field import active_field
from .shared import FieldOperator, report_fault

ITEMS = tuple((name, label, f"{label}, procedural") for name, (label, _builder) in shading.MATERIALS.items())


class STORMFIELD_OT_apply_material(FieldOperator, bpy.types.Operator):
    """Give the mesh a procedural material that turns and flows with the field"""

    bl_idname = "stormfield.apply_material"
    bl_label = "Apply Material"
    bl_options = {"REGISTER", "UNDO"}

    material: EnumProperty(name="Material", description="Which material the mesh is given", items=ITEMS)

    def execute(self, context):
        obj = active_field(context)
        try:
            material = shading.shared_material(self.material)
        except ValueError as fault:
            return report_fault(self, fault)
        if obj.active_material is None and not obj.data.materials:
            obj.data.materials.append(material)
        else:
            obj.active_material = material
        self.report({"INFO"}, f"'{obj.name}' has the material '{material.name}'")
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_apply_material,)
