# SPDX-License-Identifier: GPL-3.0-or-later
"""Add → Stormfield → Storm Merge: a planet on which two storms drift, meet and merge, solved and playing."""

import bpy
from bpy.props import EnumProperty
from mathutils import Vector

from ..presets import storm_merge
from ..presets.free_place import free_place
from ..scene.write import view
from ..session import running
from . import requirements
from .solve import SolvingOperator

WHERE = (
    (
        "HERE",
        "This Scene",
        "At the 3D cursor or, where something stands there, beside it; no setting of the scene changes",
    ),
    ("SCENE", "New Scene", "In a scene of its own, with camera, light and render settings, ready to render"),
)
#: Detail → subdivisions of the planet.
SUBDIVISIONS = {"PREVIEW": 6, "FINAL": 7}
DETAILS = (
    ("PREVIEW", "Preview", "10,242 vertices: solved in one or two seconds"),
    ("FINAL", "Final", "40,962 vertices: sharper storms, solved in some seconds"),
)
#: Distance of the view from the planet's centre, in its radii.
DISTANCE = 3.2


class STORMFIELD_OT_storm_merge(SolvingOperator, bpy.types.Operator):
    """Add a planet on which two storms drift together and merge, solve it and play it. Esc stops the solve"""

    bl_idname = "stormfield.storm_merge"
    bl_label = "Storm Merge"
    bl_options = {"REGISTER", "UNDO"}

    where: EnumProperty(name="Where", description="Which scene the planet is added to", items=WHERE)
    detail: EnumProperty(name="Detail", description="How fine the planet's mesh is", items=DETAILS)

    @classmethod
    def poll(cls, context):
        job = running.current()
        problem = requirements.problem()
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave Edit Mode first")
        elif job is not None:
            cls.poll_message_set(f"{job.title} '{job.object_name}'; press Esc to stop it")
        elif problem:
            cls.poll_message_set(problem)
        else:
            return True
        return False

    def subject(self, context):
        """The planet, made here and now."""
        own = self.where == "SCENE"
        scene = self._new_scene(context) if own else context.scene
        place = Vector() if own else free_place(context, radius=1.0)
        planet = storm_merge.build_planet(scene, SUBDIVISIONS[self.detail], place)
        if own:
            storm_merge.add_stage(scene)
        for obj in context.selected_objects:
            obj.select_set(False)
        planet.select_set(True)
        context.view_layer.objects.active = planet
        view.look_at(context, place, Vector(storm_merge.on_sphere(*storm_merge.SEEN_FROM)), DISTANCE)
        return planet

    def finish(self, context, obj, folder):
        super().finish(context, obj, folder)
        view.show_materials(context)  # not before: drawing them would take the solve's time
        view.play(context)

    def was_stopped(self, name):
        self.report(
            {"WARNING"}, f"'{name}' stands ready; press Solve in the Stormfield tab of the sidebar to see it flow"
        )
        return {"FINISHED"}  # what was built is a step to undo

    @staticmethod
    def _new_scene(context) -> bpy.types.Scene:
        scene = bpy.data.scenes.new("Storm Merge")
        scene.frame_start, scene.frame_end = 1, 84
        context.window.scene = scene
        return scene


CLASSES = (STORMFIELD_OT_storm_merge,)
