# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups that every Stormfield material is made of.

Textures move with the flow by being evaluated at advected coordinates: phase a and phase b are points carried back
along the flow to where their cycle began (``sf_phase_a``, ``sf_phase_b``), blended with the weight ``sf_blend`` of b.
A plain average of two unrelated noises x_a, x_b has less contrast than either, by sqrt(w_a² + w_b²), which reads as a
pulse twice per cycle. So deviations from the mean m are blended and scaled back:

    x = m + (w_a (x_a − m) + w_b (x_b − m)) / sqrt(w_a² + w_b²)

which keeps the variance the same at every moment.
"""

from __future__ import annotations

from ..scene.nodes.tree import Socket, Tree, add_input, group_inputs, node_group, set_outputs

COORDINATES = "Stormfield Advected Coordinates"
FLOW_NOISE = "Stormfield Flow Noise"
FLOW_VALUE = "Stormfield Phase Blend"
NOTHING = 1e-12  # length of a coordinate that stands for none


@node_group(COORDINATES)
def advected_coordinates(tree: Tree) -> None:
    """Both phases that the mesh carries, with their variance-preserving weights.

    Where none are baked yet the object's own coordinates stand in: the texture is there and does not travel."""
    weight_b = tree.attribute("sf_blend", "Fac")
    weight_a = 1.0 - weight_b
    norm = tree.math("SQRT", weight_a * weight_a + weight_b * weight_b)
    phase_a, phase_b = tree.attribute("sf_phase_a", "Vector"), tree.attribute("sf_phase_b", "Vector")
    missing = tree.math("LESS_THAN", tree.vector("LENGTH", phase_a), NOTHING)  # an attribute that is not there is 0
    place = tree.object_coordinates().scaled(missing)
    set_outputs(
        tree,
        phase_a=phase_a + place,
        phase_b=phase_b + place,
        weight_a=weight_a / norm,
        weight_b=weight_b / norm,
    )


@node_group(FLOW_VALUE)
def phase_blend(tree: Tree) -> None:
    """The two phases of any texture, of mean 0.5, blended with their variance kept."""
    for name, default in (("A", 0.5), ("B", 0.5), ("Weight A", 1.0), ("Weight B", 0.0)):
        add_input(tree, name, default)
    given = group_inputs(tree)
    blended = (given["A"] - 0.5) * given["Weight A"] + (given["B"] - 0.5) * given["Weight B"] + 0.5
    set_outputs(tree, value=blended)


@node_group(FLOW_NOISE)
def flow_noise(tree: Tree) -> None:
    """fBm carried by the flow, of mean 0.5 and constant contrast.

    ``Stretch`` shrinks the coordinates along the object's x and y: streaks along latitudes of a planet that turns
    about z. 1 = none."""
    add_input(tree, "Scale", 6.0, 0.0, 1000.0, "Features per unit length of the mesh")
    add_input(tree, "Detail", 4.0, 0.0, 15.0, "Octaves")
    add_input(tree, "Roughness", 0.55, 0.0, 1.0, "Contrast of each octave relative to the one before")
    add_input(tree, "Stretch", 1.0, 0.01, 10.0, "Frequency along x and y relative to z: below 1 gives streaks around z")
    add_input(tree, "Distortion", 0.0, 0.0, 10.0, "Curls the features")
    given = group_inputs(tree)
    carried = tree.group(advected_coordinates())
    shape = tree.combine(given["Stretch"], given["Stretch"], 1.0)
    values: dict[str, Socket] = {
        p: tree.noise(
            carried[f"Phase {p}"] * shape, given["Scale"], given["Detail"], given["Roughness"], given["Distortion"]
        )
        for p in "AB"
    }
    blend = tree.group(
        phase_blend(), a=values["A"], b=values["B"], weight_a=carried["Weight A"], weight_b=carried["Weight B"]
    )
    set_outputs(tree, value=blend["Value"])
