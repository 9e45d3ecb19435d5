# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloud tops of a gas giant, after thesis figure 11.8.

    band = stream * Band Scale + Band Offset + Turbulence * (n1 - 1/2)        colour = ramp(band)

The stream function bends the bands around every storm; n1, n2, n3 are flow noises from broad to fine, wound into
spirals by the flow itself. The storms' colour follows ``sf_rotation``.
"""

from __future__ import annotations

import bpy

from ..scene.nodes.tree import (
    Tree,
    add_input,
    add_socket,
    group_inputs,
    new_material,
    node_group,
    set_outputs,
    srgb,
)
from .groups import advected_coordinates, phase_blend

GROUP, LAYER = "Storm Clouds", "Storm Clouds Layer"
BANDS = (
    (0.00, "#1f3b54"), (0.09, "#416a86"), (0.125, "#8fabb5"), (0.15, "#c9cdc6"), (0.175, "#587f96"), (0.205, "#7b93a0"),
    (0.225, "#6f4a38"), (0.25, "#5c2413"), (0.28, "#9c4e25"), (0.305, "#cf9552"), (0.33, "#ecd6b0"), (0.355, "#d9ab74"),
    (0.375, "#bd7a45"), (0.395, "#ddbf92"), (0.42, "#efe0c6"), (0.44, "#b87240"), (0.46, "#7c3519"), (0.49, "#5f2412"),
    (0.52, "#9c5428"), (0.545, "#d6a868"), (0.57, "#ecdfc8"), (0.60, "#dcc096"), (0.64, "#ab7c50"), (0.67, "#6f452c"),
    (0.70, "#bb8d60"), (0.74, "#d6cdbd"), (0.79, "#8ea4ac"), (0.86, "#5d8297"), (1.00, "#1f3b54"),
)  # fmt: skip
STORM = (
    (0.0, "#e6cba0"), (0.16, "#b96d36"), (0.28, "#7d2f17"), (0.40, "#c9905f"), (0.46, "#dcb48a"), (0.54, "#9a4421"),
    (0.68, "#6d1f10"), (0.84, "#a84a25"), (1.0, "#571609"),
)  # fmt: skip


@node_group(LAYER)
def layer_group(tree: Tree) -> None:
    """The noises of one phase: swirls and filaments, bent by one warp, and an unbent relief."""
    add_socket(tree, "Coordinate", "NodeSocketVector")
    add_input(tree, "Eddies", 7.0, 0, 100)
    add_input(tree, "Filaments", 24.0, 0, 500)
    given = group_inputs(tree)
    coordinate = given["Coordinate"]
    streaky = coordinate * (0.45, 0.45, 1.0)
    warp = tree.noise_color(streaky, given["Eddies"] * 1.7, 0.0)
    warped = streaky + (warp - (0.5, 0.5, 0.5)).scaled(0.09)
    set_outputs(
        tree,
        broad=tree.noise(warped, given["Eddies"], 2.0, 0.55),
        fine=tree.noise(warped, given["Filaments"], 3.0, 0.72),
        relief=tree.noise(streaky, given["Filaments"] * 1.8, 1.0, 0.6),
    )


@node_group(GROUP)
def storm_clouds_group(tree: Tree) -> None:
    add_input(tree, "Band Scale", 3.85, -100, 100, "Bands per unit of the stream function")
    add_input(tree, "Band Offset", 0.5, -10, 10, "Which colour of the bands lies where the stream function is zero")
    add_input(tree, "Turbulence", 0.18, 0, 2, "How far eddies carry the bands' colours across their borders")
    add_input(tree, "Eddies", 7.0, 0, 100, "Frequency of the broad eddies, per unit of length")
    add_input(tree, "Filaments", 24.0, 0, 500, "Frequency of the filaments, per unit of length")
    add_input(tree, "Contrast", 0.75, 0, 2, "Brightness of the filaments")
    add_input(tree, "Storm Rotation", 9.0, 0.001, 100, "Rotation (sf_rotation) of a storm's core")
    add_input(tree, "Storm Tint", 0.92, 0, 1, "How much the storms' cores take the storm colours")
    add_input(tree, "Haze", 0.5, 0, 1, "Blue of the air towards the planet's rim")
    given = group_inputs(tree)
    carried = tree.group(advected_coordinates())
    layer, blend = layer_group(), phase_blend()
    a, b = (
        tree.group(layer, coordinate=carried[phase], eddies=given["Eddies"], filaments=given["Filaments"])
        for phase in ("Phase A", "Phase B")
    )

    def flow(name):
        return (
            tree.group(blend, a=a[name], b=b[name], weight_a=carried["Weight A"], weight_b=carried["Weight B"])["Value"]
            - 0.5
        )

    broad, fine = flow("Broad"), flow("Fine")
    stream = tree.attribute("sf_stream", "Fac")
    rotation = tree.attribute("sf_rotation", "Fac") / given["Storm Rotation"]
    band = stream * given["Band Scale"] + given["Band Offset"] + (broad + fine * 0.5) * given["Turbulence"]
    color = tree.color_ramp(band, BANDS)
    streak = tree.noise(band, 26.0, 2.0, 0.6) - 0.5
    core = (rotation + fine * 0.3 + broad * 0.35).ramp(0.04, 0.24)
    collar = (rotation * 5.0 + fine * 1.0).ramp(-0.15, -0.9)
    inside = tree.color_ramp(rotation * 0.4 + broad * 1.8 + fine * 0.5 + 0.3, STORM)
    color = tree.mix(collar * 0.5, color, (0.78, 0.7, 0.58, 1.0))
    color = tree.mix(core * given["Storm Tint"], color, inside)
    light = fine * (given["Contrast"] * 2.0) + streak * 0.9 + 0.95
    light = tree.math("MAXIMUM", light, 0.15)
    color = tree.mix(1.0, color, tree.combine(light, light, light), "MULTIPLY")
    edge = tree.facing()
    color = tree.mix(edge * edge * edge * given["Haze"], color, srgb("#a9c3dc"))
    set_outputs(tree, color=color, height=flow("Relief"))


def storm_clouds(relief: float = 0.0012, **settings: float) -> bpy.types.Material:
    """``relief``: height of the clouds in units of length (0: flat, and a third faster to render). The other settings
    are the inputs of the group in lower case: band_scale, band_offset, turbulence, eddies, filaments, …"""
    material, tree = new_material("Storm Clouds")
    clouds = tree.group(storm_clouds_group(), **settings)
    surface = tree.node("ShaderNodeBsdfDiffuse")
    tree.connect(clouds["Color"], surface.inputs["Color"])
    if relief > 0:
        tree.bump(clouds["Height"], surface, relief)
    tree.surface(surface)
    return material
