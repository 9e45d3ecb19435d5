# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake: the flowing texture's coordinates per frame and Morse sets over λ (attached to the object), EXR flow maps and
VDB volumes."""

import bpy

from ..bake.job import bake_steps
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.bake_task import read_bake_task
from ..scene.write import attach
from ..session import made_caches
from . import requirements
from .job_operator import JobOperator


def why_not(obj: bpy.types.Object) -> str:
    """Why nothing can be baked now, and the cure; empty when it can."""
    settings = obj.stormfield.bake
    if attached_folder(obj, LAMBDA) is None:
        return "Solve first: the bake reads the solved field"
    if not (settings.use_frames or settings.use_exr or settings.use_vdb or settings.use_morse):
        return "Switch on at least one thing to write"
    if settings.use_exr and not obj.data.uv_layers:
        return "EXR flow maps need a UV layer; unwrap the mesh, or switch them off"
    return requirements.problem()


class STORMFIELD_OT_bake(JobOperator, bpy.types.Operator):
    """Write what is switched on below for every frame, from the solved field. Esc stops; finished frames are kept"""

    bl_idname = "stormfield.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Baking"
    why_not = staticmethod(why_not)

    def start(self, context, obj):
        task = read_bake_task(context, obj, attached_folder(obj, LAMBDA))
        self._before = made_caches.existing(task.root)
        return bake_steps(task)

    def finish(self, context, obj, result):
        attach.attach_lambda(obj, result.cache)
        attach.show_baked(obj, result.folders)
        for folder in (result.cache, *result.folders.values()):
            made_caches.note_baked(folder, self._before)
        for remark in result.remarks:
            self.report({"WARNING"}, remark)
        written = ", ".join(str(folder) for folder in result.folders.values())
        self.report({"INFO"}, f"'{obj.name}' is baked: {written}")


CLASSES = (STORMFIELD_OT_bake,)
