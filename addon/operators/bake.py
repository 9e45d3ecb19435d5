"""Bake: the flowing texture's coordinates per frame (attached to the object), EXR flow maps and VDB volumes."""

from pathlib import Path

import bpy

from ..bake.exr import ExrSettings
from ..bake.job import BakeTask, FlowSettings, bake_steps
from ..bake.usd import Polygons
from ..bake.vdb import VdbSettings
from ..convert import attach, folders
from ..convert.mesh_arrays import read_mesh, read_polygons
from ..convert.scene import lambda_at_frames
from ..model.errors import InputError
from ..ui.native_state import native_problem
from .job_operator import JobOperator
from .shared import active_field


class STORMFIELD_OT_bake(JobOperator, bpy.types.Operator):
    """Write what is switched on below for every frame, from the solved field. Esc stops; finished frames are kept"""

    bl_idname = "stormfield.bake"
    bl_label = "Bake"
    bl_options = {"UNDO"}
    job_title = "Baking"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        obj = active_field(context)
        settings = obj.stormfield.bake
        problem = native_problem()
        if problem:
            cls.poll_message_set(problem)
        elif attach.attached_folder(obj, attach.LAMBDA) is None:
            cls.poll_message_set("Solve first: the bake reads the solved field")
        elif not (settings.use_frames or settings.use_exr or settings.use_vdb):
            cls.poll_message_set("Switch on at least one thing to write")
        elif settings.use_exr and not obj.data.uv_layers:
            cls.poll_message_set("EXR flow maps need a UV layer; unwrap the mesh, or switch them off")
        else:
            return True
        return False

    def start(self, context, obj):
        return bake_steps(read_task(context.scene, obj))

    def finish(self, context, obj, result):
        if "usd" in result.folders:
            attach.attach_frames(obj, result.folders["usd"])
        for remark in result.remarks:
            self.report({"WARNING"}, remark)
        written = ", ".join(str(folder) for folder in result.folders.values())
        self.report({"INFO"}, f"'{obj.name}' is baked: {written}")


def read_task(scene: bpy.types.Scene, obj: bpy.types.Object) -> BakeTask:
    """The bake that the object's settings ask for, as plain data."""
    settings = obj.stormfield.bake
    own = not settings.use_scene_frames
    first = settings.frame_start if own else scene.frame_start
    last = settings.frame_end if own else scene.frame_end
    if last < first:
        raise InputError(f"The bake ends at frame {last} before it starts at {first}; exchange the two")
    frames = list(range(first, last + 1))
    wanted = {"usd": settings.use_frames, "exr": settings.use_exr, "vdb": settings.use_vdb}
    active_layer = obj.data.uv_layers.active
    return BakeTask(
        cache=attach.attached_folder(obj, attach.LAMBDA) or Path(),
        mesh=read_mesh(obj),
        frames=tuple(frames),
        lambdas=tuple(lambda_at_frames(obj, frames)),
        root=folders.cache_root(obj),
        frames_per_second=scene.render.fps / scene.render.fps_base,
        targets=frozenset(target for target, on in wanted.items() if on),
        polygons=Polygons(*read_polygons(obj)),
        flow=FlowSettings(period=settings.period, speed=settings.speed),
        exr=ExrSettings(
            uv_layer=settings.uv_layer or (active_layer.name if active_layer else ""),
            resolution=int(settings.resolution),
        ),
        vdb=VdbSettings(voxel_size=settings.voxel_size),
    )


CLASSES = (STORMFIELD_OT_bake,)
