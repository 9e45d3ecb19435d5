# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that carry curves and points with a surface: what was found on the mesh at rest lies on the surface
that armatures, shape keys, cloth and other modifiers show.

Each point belongs to the nearest place of the surface at rest, and goes to where the same place, by its barycentric
coordinates, is seen. The places at rest are Blender's own attribute `rest_position`, which modifiers carry along.
"""

from typing import Any

from ..read.seen_surface import REST
from .tree import Socket, Tree, add_socket, group_inputs, node_group, set_outputs

#: Inputs of the group: the object with the surface; and how many of its first faces are the mesh itself, 0 for all. The
#: copies that a mirror or an array makes have the same places at rest.
SURFACE, FACES = "Surface", "Faces"


@node_group("Stormfield Follow Surface", "GeometryNodeTree")
def follow_group(tree: Tree) -> None:
    """Carries points from the surface at rest to the surface that is seen."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    add_socket(tree, SURFACE, "NodeSocketObject")
    add_socket(tree, FACES, "NodeSocketInt")
    given = group_inputs(tree)
    info: Any = tree.node("GeometryNodeObjectInfo", transform_space="RELATIVE")
    tree.connect(given[SURFACE], info.inputs["Object"])
    number = Socket(tree, tree.node("GeometryNodeInputIndex").outputs[0])
    copied = tree.math("GREATER_THAN", number + 0.5, given[FACES]) * tree.math("GREATER_THAN", given[FACES], 0.5)
    own = tree.without(Socket(tree, info.outputs["Geometry"]), "FACE", copied)
    own, (seen,) = tree.captured(own, [tree.position()])
    rest = tree.node("GeometryNodeSetPosition")
    tree.connect(own, rest.inputs["Geometry"])
    tree.connect(tree.named_attribute(REST, "FLOAT_VECTOR"), rest.inputs["Position"])
    there: Any = tree.node("GeometryNodeSampleNearestSurface", data_type="FLOAT_VECTOR")
    tree.connect(Socket(tree, rest.outputs[0]), there.inputs["Mesh"])
    tree.connect(seen, next(s for s in there.inputs if s.name == "Value" and s.enabled))
    carried = tree.node("GeometryNodeSetPosition")
    tree.connect(given["Geometry"], carried.inputs["Geometry"])
    tree.connect(Socket(tree, there.outputs["Is Valid"]), carried.inputs["Selection"])
    place = Socket(tree, next(s for s in there.outputs if s.name == "Value" and s.enabled))
    tree.connect(place, carried.inputs["Position"])
    set_outputs(tree, geometry=Socket(tree, carried.outputs[0]))
