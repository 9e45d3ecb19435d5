# SPDX-License-Identifier: GPL-3.0-or-later
"""Fibres that lie along the orientation field and travel with the advection field: hair, silk, grass seen from afar.

Blender's Gabor noise with its waves across the field, coarse strands and fine ones, in both phases.
"""

from __future__ import annotations

import bpy

from ..scene.nodes.tree import Tree, add_input, group_inputs, new_material, node_group, set_outputs
from .groups import advected_coordinates, phase_blend
from .tiles import direction

GROUP = "Stormfield Fibres"
#: Gabor noise keeps to the middle of 0 to 1.
CONTRAST = 1.8
COLOURS = ((0.0, "#1d0f08"), (0.3, "#5a3015"), (0.55, "#a8672c"), (0.8, "#dfae68"), (1.0, "#fbe7bd"))


@node_group(GROUP)
def fibres_group(tree: Tree) -> None:
    add_input(tree, "Scale", 6.0, 0, 1000, "Length of a fibre: fibres per unit of length")
    add_input(tree, "Strands", 5.0, 0, 100, "Fibres side by side in their length")
    add_input(tree, "Order", 1.0, 0, 1, "How strictly fibres follow the orientation field: 0 not at all, 1 exactly")
    add_input(tree, "Fine", 0.5, 0, 2, "Contrast of the finest fibres relative to the coarse ones")
    given = group_inputs(tree)
    carried, turned = tree.group(advected_coordinates()), tree.group(direction())

    def strands(factor: float):
        noises = {
            p.lower(): tree.gabor(
                carried[f"Phase {p}"], given["Scale"] * factor, given["Strands"], turned["Across"], given["Order"]
            )
            for p in "AB"
        }
        return (
            tree.group(phase_blend(), **noises, weight_a=carried["Weight A"], weight_b=carried["Weight B"])["Value"]
            - 0.5
        )

    coarse = strands(1.0)
    value = coarse + strands(2.7) * given["Fine"]
    set_outputs(tree, value=(value * CONTRAST + 0.5).clamped(), height=coarse)


def fibres(**settings: float) -> bpy.types.Material:
    """Settings are the inputs of the group in lower case: scale, strands, order, fine."""
    material, tree = new_material("Fibres")
    found = tree.group(fibres_group(), **settings)
    surface = tree.principled(base_color=tree.color_ramp(found["Value"], COLOURS), roughness=0.45)
    # Of the coarse strands alone: a relief asks for them three times.
    tree.bump(found["Height"], surface, distance=0.015)
    tree.surface(surface)
    return material
