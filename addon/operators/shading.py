# SPDX-License-Identifier: GPL-3.0-or-later
"""Give the field's mesh one of the flowing materials."""

from pathlib import Path

import bpy
from bpy.props import EnumProperty, StringProperty

from .. import shading
from ..model.errors import InputError
from ..scene.read.active_field import active_field
from ..shading.from_image import material_from_image
from .shared import FieldOperator, report_fault

#: Height of an image on the mesh, over the longest side of the mesh.
HEIGHT = 0.35
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
        give(obj, material)
        self.report({"INFO"}, f"'{obj.name}' has the material '{material.name}'")
        return {"FINISHED"}


class STORMFIELD_OT_material_from_image(FieldOperator, bpy.types.Operator):
    """Make any image into a material that turns and flows with the field: no UV, no seams, and its contrast stays"""

    bl_idname = "stormfield.material_from_image"
    bl_label = "Material From Image"
    bl_options = {"REGISTER", "UNDO"}

    image: StringProperty(
        name="Image", description="An image of this file that the material is made of; empty: the chosen file"
    )
    filepath: StringProperty(name="File", description="The image that the material is made of", subtype="FILE_PATH")
    filter_image: bpy.props.BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context, _event):
        if self.image or self.filepath:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        obj = active_field(context)
        known = set(bpy.data.images)
        try:
            image = self._image()
            material, remarks = material_from_image(image, HEIGHT * max(*obj.dimensions, 1e-6) / mean_scale(obj))
        except InputError as fault:
            return report_fault(self, fault)
        finally:
            # The file that was read only for this is not kept.
            for read in set(bpy.data.images) - known:
                if read.users == 0:
                    bpy.data.images.remove(read)
        give(obj, material)
        for remark in remarks:
            self.report({"INFO"}, remark)
        self.report({"INFO"}, f"'{obj.name}' has the material '{material.name}'")
        return {"FINISHED"}

    def _image(self) -> bpy.types.Image:
        if self.image:
            if (found := bpy.data.images.get(self.image)) is None:
                raise InputError(
                    f"This file has no image '{self.image}': open it in the Image Editor, or choose a file"
                )
            return found
        path = Path(bpy.path.abspath(self.filepath))
        if not self.filepath or not path.is_file():
            raise InputError(f"There is no image file '{self.filepath}': choose one, for example a PNG")
        try:
            return bpy.data.images.load(str(path), check_existing=True)
        except RuntimeError:
            raise InputError(f"'{path.name}' is no image that Blender reads: choose a PNG, JPEG or EXR") from None


def give(obj: bpy.types.Object, material: bpy.types.Material) -> None:
    if obj.active_material is None and not obj.data.materials:
        obj.data.materials.append(material)
    else:
        obj.active_material = material


def mean_scale(obj: bpy.types.Object) -> float:
    """World lengths over mesh units."""
    return max(sum(abs(s) for s in obj.matrix_world.to_scale()) / 3.0, 1e-9)


CLASSES = (STORMFIELD_OT_apply_material, STORMFIELD_OT_material_from_image)
