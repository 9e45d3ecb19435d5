# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that use a field: read it, carry points along it, draw streamlines of it. Renders need no add-on.

Lengths and times: `sf_advection` is in mesh units per second, so points move as fast as texture does.
"""

from __future__ import annotations

from typing import Any

from .tree import Socket, Tree, add_input, add_socket, group_inputs, node_group, set_outputs

#: Attributes of the field, and how they are stored (docs/formats.md).
VECTORS, NUMBERS = ("orientation", "advection"), ("speed", "stream", "rotation")


@node_group("Stormfield Read Field", "GeometryNodeTree")
def read_field(tree: Tree) -> None:
    """The field at each point of the mesh that carries it."""
    tree.tree.is_modifier = False
    outputs = {name: tree.named_attribute(f"sf_{name}", "FLOAT_VECTOR") for name in VECTORS}
    outputs |= {name: tree.named_attribute(f"sf_{name}", "FLOAT") for name in NUMBERS}
    set_outputs(tree, **outputs)


@node_group("Stormfield Advect Points", "GeometryNodeTree")
def advect_points(tree: Tree) -> None:
    """Points that travel with the field over the frames: distributed on the surface, carried and kept on it by a
    simulation. Bake the simulation for renders on several machines."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    add_input(tree, "Density", 50.0, 0.0, 1e6, "Points per square unit at the start")
    add_input(tree, "Speed", 1.0, -100.0, 100.0, "Multiplies the speed of the field")
    add_input(tree, "Radius", 0.02, 0.0, 10.0, "Radius of the points")
    given = group_inputs(tree)
    surface = given["Geometry"]
    scattered = tree.node("GeometryNodeDistributePointsOnFaces")
    tree.connect(surface, scattered.inputs["Mesh"])
    tree.connect(given["Density"], next(s for s in scattered.inputs if s.name == "Density" and s.enabled))
    begin, end = _zone(tree, "Simulation")
    tree.connect(Socket(tree, scattered.outputs["Points"]), begin.inputs["Geometry"])
    seconds = Socket(tree, begin.outputs["Delta Time"]) * given["Speed"]
    moved = _moved(tree, Socket(tree, begin.outputs["Geometry"]), surface, _advection(tree, surface).scaled(seconds))
    tree.connect(moved, end.inputs["Geometry"])
    sized = tree.node("GeometryNodeSetPointRadius")
    tree.connect(Socket(tree, end.outputs["Geometry"]), sized.inputs[0])
    tree.connect(given["Radius"], sized.inputs["Radius"])
    set_outputs(tree, geometry=Socket(tree, sized.outputs[0]))


@node_group("Stormfield Streamlines", "GeometryNodeTree")
def streamlines(tree: Tree) -> None:
    """Streamlines of the field at each frame: curves that begin at points of the surface and follow the field."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    add_input(tree, "Density", 20.0, 0.0, 1e5, "Lines per square unit")
    add_input(tree, "Length", 0.5, 0.0, 100.0, "Length of a line")
    add_input(tree, "Width", 0.01, 0.0, 10.0, "Radius of a line")
    steps = tree.tree.interface.new_socket("Steps", in_out="INPUT", socket_type="NodeSocketInt")
    steps.default_value, steps.min_value, steps.max_value = 16, 2, 200
    given = group_inputs(tree)
    surface = given["Geometry"]
    scattered = tree.node("GeometryNodeDistributePointsOnFaces")
    tree.connect(surface, scattered.inputs["Mesh"])
    tree.connect(given["Density"], next(s for s in scattered.inputs if s.name == "Density" and s.enabled))
    line = tree.node("GeometryNodeCurvePrimitiveLine")
    line.inputs["End"].default_value = (0.0, 0.0, 1e-5)
    cut = tree.node("GeometryNodeResampleCurve")
    tree.connect(Socket(tree, line.outputs[0]), cut.inputs["Curve"])
    tree.connect(given["Steps"], cut.inputs["Count"])
    placed = tree.node("GeometryNodeInstanceOnPoints")
    tree.connect(Socket(tree, scattered.outputs["Points"]), placed.inputs["Points"])
    tree.connect(Socket(tree, cut.outputs[0]), placed.inputs["Instance"])
    real = tree.node("GeometryNodeRealizeInstances")
    tree.connect(Socket(tree, placed.outputs[0]), real.inputs[0])
    # All points of a line begin in one place. In round i all but the first i take a step: the k-th takes k of them.
    begin, end = _zone(tree, "Repeat")
    tree.connect(given["Steps"], begin.inputs["Iterations"])
    tree.connect(Socket(tree, real.outputs[0]), begin.inputs["Geometry"])
    number = Socket(tree, tree.node("GeometryNodeSplineParameter").outputs["Index"])
    goes_on = tree.math("GREATER_THAN", number, Socket(tree, begin.outputs["Iteration"]))
    step = tree.vector("NORMALIZE", _advection(tree, surface)).scaled(given["Length"] / given["Steps"] * goes_on)
    moved = _moved(tree, Socket(tree, begin.outputs["Geometry"]), surface, step)
    tree.connect(moved, end.inputs["Geometry"])
    wide = tree.node("GeometryNodeSetCurveRadius")
    tree.connect(Socket(tree, end.outputs["Geometry"]), wide.inputs[0])
    tree.connect(given["Width"], wide.inputs["Radius"])
    set_outputs(tree, geometry=Socket(tree, wide.outputs[0]))


def _zone(tree: Tree, kind: str) -> tuple[Any, Any]:
    """Both ends of a Simulation or Repeat zone."""
    begin: Any = tree.node(f"GeometryNode{kind}Input")
    end: Any = tree.node(f"GeometryNode{kind}Output")
    begin.pair_with_output(end)
    items = end.state_items if kind == "Simulation" else end.repeat_items
    if "Geometry" not in items:
        items.new("GEOMETRY", "Geometry")
    return begin, end


def _advection(tree: Tree, surface: Socket) -> Socket:
    """The field of the surface at the place of the geometry that asks."""
    node: Any = tree.node("GeometryNodeSampleNearestSurface", data_type="FLOAT_VECTOR")
    tree.connect(surface, node.inputs["Mesh"])
    value = next(s for s in node.inputs if s.name == "Value" and s.enabled)
    tree.connect(tree.named_attribute("sf_advection", "FLOAT_VECTOR"), value)
    return Socket(tree, next(s for s in node.outputs if s.name == "Value" and s.enabled))


def _moved(tree: Tree, geometry: Socket, surface: Socket, by: Socket) -> Socket:
    """The points moved, and brought back onto the surface."""
    shifted = tree.node("GeometryNodeSetPosition")
    tree.connect(geometry, shifted.inputs["Geometry"])
    tree.connect(by, shifted.inputs["Offset"])
    near: Any = tree.node("GeometryNodeProximity", target_element="FACES")
    tree.connect(surface, near.inputs[0])
    back = tree.node("GeometryNodeSetPosition")
    tree.connect(Socket(tree, shifted.outputs["Geometry"]), back.inputs["Geometry"])
    tree.connect(Socket(tree, near.outputs["Position"]), back.inputs["Position"])
    return Socket(tree, back.outputs["Geometry"])
