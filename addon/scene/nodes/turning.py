# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that turn a field with its surface: armatures, shape keys, cloth, copies of an array.

A cache holds vectors of the mesh at rest. Behind all modifiers each vector is carried by the linear map F of a corner,
which takes its two edges and its unit normal at rest to those that are seen; a vertex has the mean of its corners, and
the vector is laid into the tangent plane that is seen. Where nothing moved, F is the identity. The places at rest are
Blender's own attribute `rest_position`, which modifiers carry along.
"""

from dataclasses import dataclass

from ...cache.fields import ADVECTION, ORIENTATION, SPEED
from ..read.seen_surface import REST
from .tree import Socket, Tree, add_socket, group_inputs, node_group, set_outputs

#: Input of the group: 1 keeps the speed in the world, 0 the speed over the texture.
KEEP_SPEED = "Keep Speed"
#: Corners at rest whose angle has a smaller squared sine have no map: new faces of a bevel, say.
THIN = 1e-10


@node_group("Stormfield Turn with Surface", "GeometryNodeTree")
def turn_group(tree: Tree) -> None:
    """Turns orientation and advection, and gives the speed of what became of the advection."""
    add_socket(tree, "Geometry", "NodeSocketGeometry")
    add_socket(tree, KEEP_SPEED, "NodeSocketFloat")
    given = group_inputs(tree)
    vertices = [tree.corner_vertex(offset) for offset in (0, 1, -1)]
    rest = _frame(tree, tree.named_attribute(REST, "FLOAT_VECTOR"), vertices)
    seen = _frame(tree, tree.position(), vertices)
    # All at once: Blender works out anew what several values share where each is asked for by itself.
    geometry, of_corners = tree.captured(given["Geometry"], _map(tree, rest, seen), "CORNER")
    geometry, (*rows, share) = tree.captured(geometry, of_corners)
    for name in (ORIENTATION, ADVECTION):
        vector = tree.named_attribute(name, "FLOAT_VECTOR")
        turned = _turned(tree, vector, rows, share, given[KEEP_SPEED])
        geometry = tree.with_attribute(geometry, name, "FLOAT_VECTOR", turned)
    speed = tree.vector("LENGTH", tree.named_attribute(ADVECTION, "FLOAT_VECTOR"))
    set_outputs(tree, geometry=tree.with_attribute(geometry, SPEED, "FLOAT", speed))


@dataclass(frozen=True)
class _Frame:
    """At a corner: the edges to the next and the previous vertex of its face, and the unit normal."""

    after: Socket
    before: Socket
    normal: Socket


def _frame(tree: Tree, places: Socket, vertices: list[Socket]) -> _Frame:
    own, after, before = (tree.at_vertex(places, vertex) for vertex in vertices)
    to_after, to_before = after - own, before - own
    normal = tree.vector("NORMALIZE", tree.vector("CROSS_PRODUCT", to_after, to_before))
    return _Frame(to_after, to_before, normal)


def _map(tree: Tree, rest: _Frame, seen: _Frame) -> list[Socket]:
    """Of a corner the rows of F, 0 where it has no map, and whether it has one. Their means over the corners of a
    vertex are the map there times the share of corners that have one, and that share."""
    edges = ((rest.after, rest.after), (rest.after, rest.before), (rest.before, rest.before))
    aa, ab, bb = (tree.vector("DOT_PRODUCT", *pair) for pair in edges)
    determinant = aa * bb - ab * ab
    has_map = tree.math("GREATER_THAN", determinant, aa * bb * THIN)
    scale = has_map / determinant  # 0 where the determinant is
    dual_after = (rest.after.scaled(bb) - rest.before.scaled(ab)).scaled(scale)
    dual_before = (rest.before.scaled(aa) - rest.after.scaled(ab)).scaled(scale)
    up = rest.normal.scaled(has_map)
    rows = [
        dual_after.scaled(after) + dual_before.scaled(before) + up.scaled(normal)
        for after, before, normal in zip(*(tree.components(v) for v in vars(seen).values()), strict=True)
    ]
    return [*rows, has_map]


def _turned(tree: Tree, vector: Socket, rows: list[Socket], share: Socket, keep_speed: Socket) -> Socket:
    """A vector of a vertex carried from rest to seen; one without any map stays."""
    known = tree.math("GREATER_THAN", share, 0.0)
    carried = tree.combine(*(tree.vector("DOT_PRODUCT", row, vector) for row in rows))
    mean = carried.scaled(known / share) + vector.scaled(1.0 - known)  # division by 0 gives 0
    normal = tree.vertex_normal()
    tangent = mean - normal.scaled(tree.vector("DOT_PRODUCT", mean, normal))
    there, before = tree.vector("LENGTH", mean), tree.vector("LENGTH", vector)
    return tree.vector("NORMALIZE", tangent).scaled(there + (before - there) * keep_speed)
