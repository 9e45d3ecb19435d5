# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of solve and bake settings, as Blender keeps presets everywhere."""

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase

from .shared import FieldOperator

#: Folder below a `presets` folder: the user's own, and that of the add-on.
SUBFOLDER = "stormfield"
VALUES = (
    *(f"solve.{name}" for name in ("samples", "lambda_weight", "even_speed", "tolerance")),
    *(f"bake.{name}" for name in ("period", "speed", "resolution", "voxel_size")),
)


class STORMFIELD_OT_add_preset(FieldOperator, AddPresetBase, bpy.types.Operator):
    """Keep the solve and bake settings of the active object under a name, or remove a name"""

    bl_idname = "stormfield.add_preset"
    bl_label = "Add Stormfield Preset"
    preset_menu = "STORMFIELD_PT_presets"
    preset_subdir = SUBFOLDER
    preset_defines = ["field = bpy.context.object.stormfield"]
    preset_values = [f"field.{value}" for value in VALUES]

    @classmethod
    def poll(cls, context):
        if context.object is None or not context.object.stormfield.enabled:
            cls.poll_message_set("Make the mesh with the field the active object")
            return False
        return True


def register_folder() -> None:
    bpy.utils.register_preset_path(str(Path(__file__).parents[1]))


def unregister_folder() -> None:
    bpy.utils.unregister_preset_path(str(Path(__file__).parents[1]))


CLASSES = (STORMFIELD_OT_add_preset,)
