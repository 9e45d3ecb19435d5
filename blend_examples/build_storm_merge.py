# SPDX-License-Identifier: GPL-3.0-or-later
"""Two storms of a gas giant spiral towards each other and merge; the bands bend around them (thesis figure 11.8)."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example

NAME, STILL = "storm_merge", 40


def build(options: example.Options) -> bpy.types.Object:
    preset = example.part("presets.storm_merge")
    return preset.build(bpy.context, subdivisions=7 + options.detail, frames=options.frames)


def main() -> None:
    options = example.parse(NAME, __doc__, frames=84)
    example.begin(options)
    planet = build(options)
    example.solve_and_bake(options, planet, NAME)
    example.print_flicker(planet)
    example.render(options, NAME, min(STILL, options.frames))


if __name__ == "__main__":
    example.run(main)
