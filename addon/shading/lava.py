# SPDX-License-Identifier: GPL-3.0-or-later
"""Lava: a dark crust that the flow carries, with glowing cracks between its floes (thesis figure 11.7, right).

The cracks are the level set n = 1/2 of one flow noise. A level set of blended phases is as thin and as bright as that
of a single one, where blending two pictures of cracks would show both at half brightness.

    heat = exp(−((n − 1/2) / Crack Width)²) and a wider, weaker halo
"""

from __future__ import annotations

import bpy

from ..scene.nodes.tree import Tree, add_input, group_inputs, new_material, node_group, set_outputs
from .groups import flow_noise

GROUP = "Stormfield Lava"
GLOW = ((0.0, "#000000"), (0.25, "#3a0500"), (0.5, "#b01e00"), (0.75, "#ff5a08"), (1.0, "#ffb040"))
CRUST = ((0.25, "#120f0e"), (0.5, "#2a221e"), (0.75, "#54453c"))


@node_group(GROUP)
def lava_group(tree: Tree) -> None:
    add_input(tree, "Scale", 3.0, 0, 100, "Floes of crust per unit of length")
    add_input(tree, "Crack Width", 0.022, 0.001, 1, "Share of the surface that glows")
    add_input(tree, "Roughness", 0.55, 0, 1, "Raggedness of the cracks")
    given = group_inputs(tree)
    noise = flow_noise()

    def flow(**inputs):
        return tree.group(noise, **inputs)["Value"] - 0.5

    floes = flow(scale=given["Scale"], detail=4.0, roughness=given["Roughness"], distortion=0.4)
    grain = flow(scale=given["Scale"] * 5.0, detail=4.0, roughness=0.65)
    distance = (floes + grain * 0.03) / given["Crack Width"]
    core = tree.math("EXPONENT", distance * distance * -1.0)
    halo = tree.math("EXPONENT", distance * distance * -0.12)
    heat = core * (grain * 1.5 + 0.65) + halo * (grain * 0.8 + 0.24)
    set_outputs(
        tree,
        crust=tree.color_ramp(grain + 0.5, CRUST),
        glow=tree.color_ramp(heat, GLOW),
        heat=heat,
        height=grain * 0.6 - halo * 0.6,
    )


def lava(**settings: float) -> bpy.types.Material:
    """Settings are the inputs of the group in lower case: scale, crack_width, roughness."""
    material, tree = new_material("Lava")
    parts = tree.group(lava_group(), **settings)
    surface = tree.principled(base_color=parts["Crust"], roughness=0.75, emission_color=parts["Glow"])
    tree.connect(parts["Heat"] * parts["Heat"] * 3.5, surface.inputs["Emission Strength"])
    tree.bump(parts["Height"], surface, distance=0.05)
    tree.surface(surface)
    return material
