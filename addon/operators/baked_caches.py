# SPDX-License-Identifier: GPL-3.0-or-later
"""Use Baked Caches: what a farm or another machine has baked for the present settings is shown in the scene."""

import bpy

from ..model.errors import InputError
from ..scene.read.active_field import active_field
from ..scene.read.finished_caches import not_shown, read_finished
from ..scene.read.folders import cache_root
from ..scene.write import attach
from ..session import found_caches, freshness
from . import requirements
from .shared import FieldOperator, report_fault


class STORMFIELD_OT_use_baked_caches(FieldOperator, bpy.types.Operator):
    """Look for finished caches that belong to the present settings, such as a farm has baked, and show them"""

    bl_idname = "stormfield.use_baked_caches"
    bl_label = "Use Baked Caches"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        problem = requirements.problem()
        if problem:
            cls.poll_message_set(problem)
        return not problem

    def execute(self, context):
        obj = active_field(context)
        try:
            found = read_finished(context, obj)
            words = not_shown(obj, found)
            if found.solved is not None:
                attach.show_solved(obj, found.solved)
                attach.show_baked(obj, found.targets)
                freshness.keep(obj, freshness.read(obj))
        except (InputError, OSError) as fault:
            return report_fault(self, fault)
        found_caches.forget(obj)
        if found.solved is None:
            self.report({"WARNING"}, f"No finished cache in {cache_root(obj)} belongs to the present settings")
            return {"CANCELLED"}
        shown = f"shows its {', '.join(words)} as baked" if words else "shows all that is baked already"
        self.report({"INFO"}, f"'{obj.name}' {shown}")
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_use_baked_caches,)
