# SPDX-License-Identifier: GPL-3.0-or-later
"""Stripes along the orientation field, moved by the advection field (thesis 9.2, figure 9.1).

Each phase is phasor noise: Gabor kernels whose waves run across the orientation field, evaluated at the advected
coordinates, give an angle φ and an intensity r. The phases add as complex numbers,

    z = w_a r_a exp(i φ_a) + w_b r_b exp(i φ_b),      stripe = 1/2 + 1/2 cos(arg z),

so the stripes stay crisp while one cycle gives way to the next.
"""

from __future__ import annotations

import bpy

from ..scene.nodes.tree import Tree, add_input, group_inputs, new_material, node_group, set_outputs, srgb
from .groups import advected_coordinates, flow_noise

GROUP = "Stormfield Stripes"


@node_group(GROUP)
def stripes_group(tree: Tree) -> None:
    add_input(tree, "Scale", 3.0, 0, 1000, "Size of a patch of stripes: patches per unit of length")
    add_input(tree, "Stripes", 3.0, 0, 100, "Stripes across one patch")
    add_input(tree, "Sharpness", 2.0, 0, 20, "Steepness of the stripes' edges")
    add_input(tree, "Wear", 0.25, 0, 1, "How much noise eats into the edges")
    add_input(tree, "Eye Speed", 0.12, 0, 100, "Below this speed of the orientation field the stripes fade out")
    given = group_inputs(tree)
    carried = tree.group(advected_coordinates())
    along = tree.attribute("sf_orientation", "Vector")
    normal = tree.object_normal()
    across = tree.vector("NORMALIZE", tree.vector("CROSS_PRODUCT", normal, along))
    parts = [
        tree.phasor(carried[f"Phase {p}"], given["Scale"], given["Stripes"], across, carried[f"Weight {p}"])
        for p in "AB"
    ]
    angle = tree.math("ARCTAN2", parts[0][1] + parts[1][1], parts[0][0] + parts[1][0])
    wear = tree.group(flow_noise(), scale=given["Scale"] * 8.0, detail=3.0)["Value"] - 0.5
    # At a fixed point the direction is undefined: a plain eye covers it.
    eye = tree.vector("LENGTH", along).ramp(0.0, 1.0, given["Eye Speed"])
    wave = tree.math("COSINE", angle) * eye - (1.0 - eye) * 0.8 + wear * given["Wear"] * 4.0
    set_outputs(tree, stripe=(wave * given["Sharpness"] * 0.5 + 0.5).clamped(), wave=wave, wear=wear, angle=angle)


def brushed_stripes(**settings: float) -> bpy.types.Material:
    """Settings are the inputs of the group in lower case: scale, stripes, sharpness, wear."""
    material, tree = new_material("Brushed Stripes")
    parts = tree.group(stripes_group(), **settings)
    paint = tree.mix(parts["Wear"] + 0.5, srgb("#0f4650"), srgb("#1f7f86"))
    metal = tree.mix(parts["Wear"] + 0.5, srgb("#d9a866"), srgb("#f6e6c8"))
    surface = tree.principled(base_color=tree.mix(parts["Stripe"], paint, metal), roughness=0.38)
    tree.connect(parts["Stripe"] * 0.85, surface.inputs["Metallic"])
    tree.bump(parts["Stripe"], surface, distance=0.01)
    tree.surface(surface)
    return material
