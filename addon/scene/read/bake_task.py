# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's bake settings → the plain task that addon/bake/job.py runs."""

from pathlib import Path

import bpy

from ...bake.task import BakeTask, ExrSettings, FlowSettings, MorseSettings, VdbSettings
from ...model.errors import InputError
from .folders import cache_root
from .lambda_seen import lambda_at_frames
from .mesh import read_mesh, read_polygons


def read_bake_task(context: bpy.types.Context, obj: bpy.types.Object, cache: Path) -> BakeTask:
    """What the Bake panel says, for the λ cache in folder `cache`."""
    scene, settings = context.scene, obj.stormfield.bake
    if settings.use_scene_frames:
        first, last = scene.frame_start, scene.frame_end
    else:
        first, last = settings.frame_start, settings.frame_end
    if last < first:
        raise InputError(f"The bake ends at frame {last} before it starts at {first}; exchange the two")
    frames = list(range(first, last + 1))
    switches = {
        "usd": settings.use_frames, "exr": settings.use_exr, "vdb": settings.use_vdb, "morse": settings.use_morse
    }  # fmt: skip
    active = obj.data.uv_layers.active
    return BakeTask(
        cache=cache,
        mesh=read_mesh(obj),
        frames=tuple(frames),
        lambdas=tuple(lambda_at_frames(context, obj, frames)),
        root=cache_root(obj),
        frames_per_second=scene.render.fps / scene.render.fps_base,
        targets=frozenset(target for target, on in switches.items() if on),
        polygons=read_polygons(obj),
        flow=FlowSettings(period=settings.period, speed=settings.speed),
        exr=ExrSettings(
            uv_layer=settings.uv_layer or (active.name if active else ""), resolution=int(settings.resolution)
        ),
        vdb=VdbSettings(voxel_size=settings.voxel_size),
        morse=read_morse_settings(obj),
    )


def read_morse_settings(obj: bpy.types.Object) -> MorseSettings:
    """What the Morse panel says, for the shown field; 0 means a value found from mesh and field."""
    settings, attribute = obj.stormfield.morse, obj.stormfield.look.shown_field
    if settings.method == "geometry":
        return MorseSettings(attribute, eps=settings.eps / 100.0)
    tau = settings.tau if settings.method == "tau" else settings.length
    return MorseSettings(attribute, settings.method, tau or None)
