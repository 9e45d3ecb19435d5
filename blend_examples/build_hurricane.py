# SPDX-License-Identifier: GPL-3.0-or-later
"""Hurricane Michael, October 2018: real wind on a globe with clouds that flow, and the storm's own path.

The data are 10 m wind of NOAA's GFS model, every three hours from the 6th to the 10th, in the file
gfs_wind_michael_2018.npz of the folder that STORMFIELD_DATA names.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example

NAME, STILL, DATA = "hurricane", 80, "gfs_wind_michael_2018.npz"
#: Where the storm is at first, and how near a path has to begin: degrees north and east, and their length on the globe.
BEGIN, NEAR = (17.0, -87.0), 0.03
SEEN_FROM = (22.0, -84.0)
FACES = 81920
#: Brightness of the material's clouds, and colours of a sea and of clouds above it.
SEA_AND_CLOUDS = (
    (0.04, (0.004, 0.02, 0.07, 1.0)),
    (0.16, (0.02, 0.09, 0.2, 1.0)),
    (0.34, (0.28, 0.42, 0.52, 1.0)),
    (0.65, (0.9, 0.93, 0.95, 1.0)),
)


def on_globe(latitude: float, longitude: float, radius: float = 1.0) -> np.ndarray:
    phi, theta = np.radians(latitude), np.radians(longitude)
    return radius * np.array([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)])


def data_file() -> Path:
    folder = os.environ.get("STORMFIELD_DATA")
    if not folder or not (Path(folder) / DATA).exists():
        raise SystemExit(f"This example needs {DATA}; name its folder with the variable STORMFIELD_DATA")
    return Path(folder) / DATA


def path_of_the_storm(globe: bpy.types.Object) -> np.ndarray:
    """(k, 3) the longest path of a fixed point that begins where the storm was."""
    attached, steps = example.part("scene.read.attached"), example.part("analysis.steps")
    cache = example.part("cache.field_cache").open_cache(attached.attached_folder(globe, attached.LAMBDA))
    found = example.part("work").run(steps.tracking_steps(cache, cache.mesh, "sf_advection", persistence=0.005))
    begin = on_globe(*BEGIN)
    near = [path for path in found.paths if np.linalg.norm(path.positions[0] - begin) < NEAR and path.index > 0]
    if not near:
        raise SystemExit("no fixed point begins where the storm was; use a finer sphere")
    return max(near, key=lambda path: path.life).positions


def main() -> None:
    options = example.parse(NAME, __doc__.splitlines()[0], frames=96)
    data = data_file()
    example.begin(options)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, options.frames
    parts, shading = example.part("presets.parts"), example.part("shading")
    faces = max(int(FACES * 4.0**options.detail), 20000)
    if bpy.ops.stormfield.import_data(filepath=str(data), sphere_faces=faces) != {"FINISHED"}:
        raise SystemExit(f"{data} could not be imported")
    globe = bpy.context.object
    globe.stormfield.bake.period = 24
    clouds = shading.build_material("storm_clouds")
    recolour(clouds)
    globe.data.materials.append(clouds)
    path = path_of_the_storm(globe)
    curve = parts.curve_object("Michael", 1.004 * path, scene.collection, globe)
    curve.data.bevel_depth = 0.004
    curve.data.materials.append(bright("Path", (1.0, 0.05, 0.01)))
    parts.add_sun(scene, tuple(on_globe(30.0, -50.0)), 4.0)
    parts.add_camera(scene, tuple(on_globe(*SEEN_FROM, 2.6)), tuple(on_globe(*SEEN_FROM, 1.0)), lens=45.0)
    parts.set_world(scene, (0.01, 0.012, 0.02))
    parts.set_cycles(scene, 24)
    scene.render.resolution_x = scene.render.resolution_y = 900
    example.bake(options, globe, NAME)
    print(f"path of the storm: {len(path)} samples, to {end_of(path)}", flush=True)
    example.render(options, NAME, min(STILL, options.frames))


def end_of(path: np.ndarray) -> str:
    latitude, longitude = np.degrees([np.arcsin(path[-1][2]), np.arctan2(path[-1][1], path[-1][0])])
    return f"{latitude:.1f} N {-longitude:.1f} W"


def recolour(material: bpy.types.Material) -> None:
    """The colours of a gas giant become those of the earth, by brightness."""
    tree = material.node_tree
    link = next(link for link in tree.links if link.from_node.type == "GROUP" and link.from_socket.name == "Color")
    source, target = link.from_socket, link.to_socket
    brightness, ramp = tree.nodes.new("ShaderNodeRGBToBW"), tree.nodes.new("ShaderNodeValToRGB")
    elements = ramp.color_ramp.elements
    while len(elements) < len(SEA_AND_CLOUDS):
        elements.new(1.0)
    for element, (position, color) in zip(elements, SEA_AND_CLOUDS, strict=True):
        element.position, element.color = position, color
    tree.links.new(source, brightness.inputs[0])
    tree.links.new(brightness.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], target)


def bright(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """A material that shines by itself."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value = (*color, 1.0)
    shader.inputs["Emission Strength"].default_value = 1.2
    return material


if __name__ == "__main__":
    example.run(main)
