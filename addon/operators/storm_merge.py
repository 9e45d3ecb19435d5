# SPDX-License-Identifier: GPL-3.0-or-later
"""Add → Stormfield → Storm Merge: a planet on which two storms drift, meet and merge, ready to solve."""

import bpy

from ..presets import storm_merge
from .shared import report_fault


class STORMFIELD_OT_storm_merge(bpy.types.Operator):
    """Set up a whole scene: planet, two storms' paths, keys of λ, material, camera and light. Then press Solve"""

    bl_idname = "stormfield.storm_merge"
    bl_label = "Storm Merge"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave Edit Mode first")
            return False
        return True

    def execute(self, context):
        try:
            planet = storm_merge.build(context)
        except ValueError as fault:
            return report_fault(self, fault)
        for obj in context.selected_objects:
            obj.select_set(False)
        planet.select_set(True)
        context.view_layer.objects.active = planet
        self.report({"INFO"}, "Storm Merge is set up; press Solve in the Stormfield tab of the sidebar")
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_storm_merge,)
