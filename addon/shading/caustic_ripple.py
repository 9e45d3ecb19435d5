# SPDX-License-Identifier: GPL-3.0-or-later
"""Light through ripples: bright thin lines on deep water, carried by the flow (thesis figure 11.7, middle).

Caustics are bright where the ripples focus: a sharp ridge 1/(1 + (k (n − 1/2))²) of a flow noise n; two of them at
different scales cross as rays do.
"""

from __future__ import annotations

import bpy

from ..scene.nodes.tree import Tree, add_input, group_inputs, new_material, node_group, set_outputs
from .groups import flow_noise

GROUP = "Stormfield Caustics"


@node_group(GROUP)
def caustics_group(tree: Tree) -> None:
    add_input(tree, "Scale", 4.0, 0, 1000, "Ripples per unit of length")
    add_input(tree, "Focus", 45.0, 1, 200, "Thinness of the lines of light")
    given = group_inputs(tree)
    noise = flow_noise()

    def rays(scale):
        n = tree.group(noise, scale=scale, detail=0.6, roughness=0.35, distortion=0.5)["Value"] - 0.5
        k = n * given["Focus"]
        return 1.0 / (k * k + 1.0)

    first, second = rays(given["Scale"]), rays(given["Scale"] * 1.7)
    set_outputs(tree, light=first * 0.55 + second * 0.35 + first * second * 1.2)


def caustic_ripple(**settings: float) -> bpy.types.Material:
    """Settings are the inputs of the group in lower case: scale, focus."""
    material, tree = new_material("Caustic Ripple")
    light = tree.group(caustics_group(), **settings)["Light"]
    color = tree.color_ramp(light, ((0.0, "#05283c"), (0.12, "#0a4a60"), (0.4, "#2c9aa0"), (1.0, "#eafff2")))
    surface = tree.principled(base_color=color, roughness=0.2, emission_color=color)
    tree.connect(light * light * 0.8, surface.inputs["Emission Strength"])
    tree.surface(surface)
    return material
