# SPDX-License-Identifier: GPL-3.0-or-later
"""One vortex rises over a mannequin's face and splits in two, and the stripes with it (thesis figure 11.9)."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example
import shapes

NAME, STILL = "split", 46
SPLIT = 0.5  # λ at which one vortex becomes two
PARTING = (0.0, 0.10)
RISING = ((0.0, -0.52), (0.0, -0.3), PARTING)
WEST = (PARTING, (-0.1, 0.26), (-0.24, 0.42), (-0.34, 0.62))
EAST = (PARTING, (0.1, 0.26), (0.24, 0.42), (0.34, 0.62))


def design(scene: bpy.types.Scene, head: bpy.types.Object) -> None:
    parts = example.part("presets.parts")
    collection = parts.element_collection(scene, head)
    vortex = {"type": "singular", "kind": "vortex_ccw", "strength": 0.1, "radius": 0.17}
    for name, places, start, end in (
        ("Rising", RISING, 0.0, SPLIT), ("West", WEST, SPLIT, 1.0), ("East", EAST, SPLIT, 1.0),
    ):  # fmt: skip
        source = parts.curve_object(name, shapes.front_points(head, places), collection)
        parts.add_element(head, source, lam_start=start, lam_end=end, **vortex)
    shoulders = [(x, -1.42) for x in (-0.6, -0.3, 0.0, 0.3, 0.6)]
    source = parts.curve_object("Shoulders", shapes.front_points(head, shoulders), collection)
    parts.add_element(head, source, type="streamline", strength=0.06, radius=0.12)


def main() -> None:
    options = example.parse(NAME, __doc__, frames=72)
    example.begin(options)
    scene = bpy.context.scene
    parts, shading = example.part("presets.parts"), example.part("shading")
    head = shapes.add_head(scene, voxel_size=0.04 * 2**-options.detail)
    scene.frame_start, scene.frame_end = 1, options.frames
    design(scene, head)
    parts.add_field(head, scene, samples=60, period=48, even_speed=0.7)
    head.data.materials.append(shading.build_material("brushed_stripes", scale=6.0, stripes=2.0))
    parts.add_studio(scene, 720, 720)
    parts.add_camera(scene, (0.6, -5.2, 0.3), (0.0, 0.0, -0.22), lens=62.0)
    example.solve_and_bake(options, head, NAME)
    example.print_flicker(head)
    example.render(options, NAME, min(STILL, options.frames))


if __name__ == "__main__":
    example.run(main)
