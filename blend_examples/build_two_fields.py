# SPDX-License-Identifier: GPL-3.0-or-later
"""Two fields on one ring (thesis 9.2, figure 9.1): the orientation field turns the stripes from along the ring to
around its tube, while the advection field moves them along it all the time."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example
import shapes

NAME, STILL = "two_fields", 30
MAJOR, MINOR = 1.0, 0.42


def on_ring(along: float, around: float) -> tuple[float, float, float]:
    """The point at these angles along the ring and around its tube."""
    radius = MAJOR + MINOR * math.cos(around)
    return (radius * math.cos(along), radius * math.sin(along), MINOR * math.sin(around))


def design(scene: bpy.types.Scene, ring: bpy.types.Object) -> None:
    parts = example.part("presets.parts")
    collection = parts.element_collection(scene, ring)
    turns = [math.tau * step / 48 for step in range(48)]
    # The orientation: at the start along the ring, at the end around the tube, at eight places each.
    for corner in range(4):
        around = math.tau * corner / 4
        source = parts.curve_object(f"Along {corner}", [on_ring(t, around) for t in turns], collection, cyclic=True)
        lam = {"lam_start": 0.0, "lam_end": 0.15}
        parts.add_element(ring, source, type="streamline", field="orientation", strength=0.2, radius=0.12, **lam)
        parts.add_element(ring, source, type="streamline", field="advection", strength=0.09, radius=0.12)
        ring.stormfield.elements[-1].name = f"Current {corner}"
    for corner in range(6):
        along = math.tau * corner / 6
        source = parts.curve_object(f"Around {corner}", [on_ring(along, t) for t in turns], collection, cyclic=True)
        lam = {"lam_start": 0.85, "lam_end": 1.0}
        parts.add_element(ring, source, type="streamline", field="orientation", strength=0.2, radius=0.12, **lam)


def main() -> None:
    options = example.parse(NAME, __doc__, frames=60)
    example.begin(options)
    scene = bpy.context.scene
    parts, shading = example.part("presets.parts"), example.part("shading")
    ring = shapes.add_ring(scene, MAJOR, MINOR, options.detail)
    scene.frame_start, scene.frame_end = 1, options.frames
    design(scene, ring)
    parts.add_field(ring, scene, samples=40, period=36, even_speed=0.8)
    ring.data.materials.append(shading.build_material("brushed_stripes", scale=4.5, stripes=2.0))
    parts.add_studio(scene, 800, 600)
    parts.add_camera(scene, (0.0, -4.2, 3.2), (0.0, 0.0, -0.05), lens=60.0)
    example.solve_and_bake(options, ring, NAME)
    example.render(options, NAME, min(STILL, options.frames))


if __name__ == "__main__":
    example.run(main)
