# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the bake: what is written besides the λ cache, where, and for which frames."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..bake.task import FlowSettings
from .overridable import overridable

RESOLUTIONS = tuple((str(n), f"{n} px", f"{n} × {n} pixels") for n in (256, 512, 1024, 2048, 4096))


@overridable
class BakeProperties(bpy.types.PropertyGroup):
    folder: StringProperty(
        name="Cache Folder",
        subtype="DIR_PATH",
        default="",
        options={"ANIMATABLE", "PATH_SUPPORTS_BLEND_RELATIVE"},
        description="Folder of this object's caches; empty means stormfield_cache beside the .blend file, "
        "or Blender's temporary folder until the file is saved",
    )
    use_frames: BoolProperty(
        name="Flowing Texture",
        default=True,
        description="Bake coordinates that travel with the advection field, per frame, for materials that flow",
    )
    use_exr: BoolProperty(
        name="EXR Flow Maps",
        default=False,
        description="Write one flow map image per frame in the UV layer chosen, for other programs and shaders",
    )
    use_vdb: BoolProperty(
        name="VDB Volumes",
        default=False,
        description="Write one narrow-band vector volume per frame around the surface, for smoke and particles",
    )
    use_morse: BoolProperty(
        name="Flow Regions",
        default=False,
        description="Divide the surface at every λ sample, as the panel Flow Regions says (Morse sets), into the face "
        "attributes sf_morse (number of the set, the same at every λ; -1 is none) and sf_morse_kind (0 source, 1 sink, "
        "2 saddle, 3 attracting, 4 repelling, 5 trivial, 6 other)",
    )
    use_scene_frames: BoolProperty(name="Scene Frames", description="Bake the frame range of the scene", default=True)
    frame_start: IntProperty(name="Start", description="First frame baked (frame number)", default=1)
    frame_end: IntProperty(name="End", description="Last frame baked (frame number)", default=250)
    period: IntProperty(
        name="Period",
        description="Frames after which a phase of the flowing texture starts anew; longer stretches "
        "the texture more, shorter renews it more often (frames)",
        min=2,
        soft_max=240,
        max=100000,
        default=FlowSettings().period,
    )
    speed: FloatProperty(
        name="Flow Speed",
        description="Multiplies the speed at which the advection field carries texture (factor)",
        min=0.0,
        soft_max=10.0,
        max=1000.0,
        default=FlowSettings().speed,
    )
    uv_layer: StringProperty(name="UV Layer", description="UV layer of the flow maps; empty means the active layer")
    resolution: EnumProperty(
        name="Resolution", description="Width and height of each flow map (pixels)", items=RESOLUTIONS, default="1024"
    )
    voxel_size: FloatProperty(
        name="Voxel Size",
        description="Edge of one voxel, in mesh units (object space); 0 takes the mean edge length of the mesh",
        min=0.0,
        soft_max=1.0,
        default=0.0,
        precision=4,
        step=0.1,
    )
    flow_maps: StringProperty(
        name="Flow Maps",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        description="Folder of the flow maps that were baked last",
    )
    volumes: StringProperty(
        name="Volumes",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        description="Folder of the volumes that were baked last",
    )
