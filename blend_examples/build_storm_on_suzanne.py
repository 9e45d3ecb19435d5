# SPDX-License-Identifier: GPL-3.0-or-later
"""Any mesh will do: two storms meet on the forehead of Blender's monkey (three components, with boundaries) as lava,
and on her voxel remesh (one closed surface) as brushed stripes."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example
import shapes

NAME, STILL = "storm_on_suzanne", 24
MEETING = (0.0, 0.52)
# Ways over the front of the face, as (x, z).
WEST = ((-0.72, 0.30), (-0.66, 0.52), (-0.45, 0.66), (-0.2, 0.66), MEETING)
EAST = ((0.72, 0.30), (0.66, 0.52), (0.45, 0.66), (0.2, 0.66), MEETING)
TOGETHER = (MEETING, (0.0, 0.42), (0.0, 0.30))
MERGE = 0.6


def design(scene: bpy.types.Scene, monkey: bpy.types.Object, eyes: bool) -> None:
    parts = example.part("presets.parts")
    collection = parts.element_collection(scene, monkey)

    def curve(name, places, **settings):
        source = parts.curve_object(f"{name} of {monkey.name}", shapes.front_points(monkey, places), collection)
        source.parent = monkey
        parts.add_element(monkey, source, **settings)

    storm = {"type": "singular", "kind": "vortex_ccw", "strength": 0.16, "radius": 0.16}
    curve("Storm West", WEST, lam_end=MERGE, **storm)
    curve("Storm East", EAST, lam_end=MERGE, **storm)
    curve("Merged Storm", TOGETHER, lam_start=MERGE, **storm)
    muzzle = ((-0.16, -0.5), (-0.06, -0.56), (0.06, -0.56), (0.16, -0.5))
    curve("Muzzle", muzzle, type="streamline", strength=0.1, radius=0.08)
    if eyes:  # components of their own: without an element their field would be zero
        for side, x in (("West", -0.35), ("East", 0.35)):
            middle = shapes.front_points(monkey, [(x, 0.25)])[0]
            source = parts.empty_object(f"{side} Eye of {monkey.name}", middle, collection)
            source.parent = monkey
            parts.add_element(monkey, source, type="singular", kind="vortex_cw", strength=0.08, radius=0.15)


def main() -> None:
    options = example.parse(NAME, __doc__, frames=48)
    example.begin(options)
    scene = bpy.context.scene
    parts, shading = example.part("presets.parts"), example.part("shading")
    monkeys = (
        (shapes.add_monkey(scene, 3 + options.detail), "lava", -1.42),
        (shapes.add_monkey(scene, 3, voxel_size=0.035 * 2**-options.detail), "brushed_stripes", 1.42),
    )
    scene.frame_start, scene.frame_end = 1, options.frames
    for monkey, material, x in monkeys:
        design(scene, monkey, eyes=material == "lava")
        monkey.location.x = x
        parts.add_field(monkey, scene, samples=40, period=48, even_speed=0.7)
        monkey.data.materials.append(shading.build_material(material))
    parts.add_studio(scene, 960, 480)
    parts.add_camera(scene, (0.0, -9.0, 1.0), (0.0, 0.0, 0.0), lens=56.0)
    for monkey, _material, _x in monkeys:
        example.solve_and_bake(options, monkey, NAME)
    example.render(options, NAME, min(STILL, options.frames))


if __name__ == "__main__":
    example.run(main)
