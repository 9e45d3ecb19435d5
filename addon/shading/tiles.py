# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of an image on any surface, without UV: pieces that overlap, each another part, turned by the field.

Space is filled with tetrahedra, as for simplex noise (in the plane they are the triangles between hexagons); each of
their corners has a tile, and four tiles meet at every point. With c the corner's place, t the direction of the
orientation field and n the normal, the tile shows its image at

    (u, v) = ((x − c)·t, (x − c)·(n × t)) / size + part of the corner

so it lies along the field wherever it is. The weights grow with the barycentric coordinates in the tetrahedron and have
the squared sum 1.
"""

from __future__ import annotations

from ..scene.nodes.tree import Socket, Tree, add_input, add_socket, group_inputs, node_group, set_outputs

TILES, FRAME = "Stormfield Tiles", "Stormfield Direction"
#: Slower than this the field has no direction, and one is made up.
STILL = 1e-9
#: From a corner to the farthest point of its tile, in cells (K. Perlin's skew of three dimensions).
REACH = 1.0


@node_group(FRAME)
def direction(tree: Tree) -> None:
    """Unit vectors along and across the orientation field, in the surface."""
    normal = tree.object_normal()
    given = tree.attribute("sf_orientation", "Vector")
    still = tree.math("LESS_THAN", tree.vector("LENGTH", given), STILL)
    # Where there is none: something that is nowhere along a normal of boxes, balls and planes.
    somewhere = given + tree.combine(still * 0.83, still * 0.47, still * 0.31)
    across = tree.vector("NORMALIZE", tree.vector("CROSS_PRODUCT", normal, somewhere))
    set_outputs(tree, along=tree.vector("CROSS_PRODUCT", across, normal), across=across)


@node_group(TILES)
def tiles(tree: Tree) -> None:
    """Where in the image the four tiles at a coordinate are looked up (UV 1 to UV 4), and their weights."""
    for name in ("Coordinate", "Along", "Across"):
        add_socket(tree, name, "NodeSocketVector")
    add_input(tree, "Size", 1.0, 1e-6, 1e6, "Length that the image's height takes on the surface, mesh units")
    add_input(tree, "Aspect", 1.0, 1e-6, 1e6, "Width over height of the image")
    add_input(tree, "Tile", 0.25, 0.01, 0.5, "Radius of a tile over the shorter side of the image")
    add_input(tree, "Margin", 0.25, 0.0, 0.5, "Distance of tiles' centers from the image's sides, over the shorter one")
    add_input(tree, "Sharpness", 4.0, 1.0, 32.0, "How narrow the seams are in which tiles blend")
    given = group_inputs(tree)
    shorter = given["Size"] * tree.math("MINIMUM", given["Aspect"], 1.0)
    cell = shorter * given["Tile"] / REACH
    x = given["Coordinate"].scaled(1.0 / cell)
    # Into the lattice of cubes, each cut into six tetrahedra by the order of the coordinates inside.
    skewed = x + _diagonal(tree, _sum(tree, x) * (1.0 / 3.0))
    corner = tree.vector("FLOOR", skewed)
    inside = skewed - corner
    a, b, c = tree.components(inside)
    high = tree.math("MAXIMUM", tree.math("MAXIMUM", a, b), c)
    low = tree.math("MINIMUM", tree.math("MINIMUM", a, b), c)
    middle = a + b + c - high - low
    steps = [tree.combine(*(tree.math("COMPARE", k, level, 1e-7) for k in (a, b, c))) for level in (high, low)]
    second = corner + steps[0]
    fourth = tree.vector("ADD", corner, 1.0)
    corners = [corner, second, fourth - steps[1], fourth]
    powers = [
        tree.math("POWER", tree.math("MAXIMUM", weight, 0.0), given["Sharpness"])
        for weight in (1.0 - high, high - middle, middle - low, low)
    ]
    norm = tree.math("SQRT", sum((p * p for p in powers[1:]), powers[0] * powers[0]))
    outputs: dict[str, Socket] = {}
    margins = [given["Margin"] * shorter / (given["Size"] * given["Aspect"]), given["Margin"] * shorter / given["Size"]]
    for k, place in enumerate(corners, 1):
        way = (x - place + _diagonal(tree, _sum(tree, place) * (1.0 / 6.0))).scaled(cell)
        random = tree.components(tree.white_noise(place))
        u, v = (
            tree.vector("DOT_PRODUCT", way, given[axis]) / length + margin + share * (1.0 - margin * 2.0)
            for axis, length, margin, share in zip(
                ("Along", "Across"), (given["Size"] * given["Aspect"], given["Size"]), margins, random, strict=False
            )
        )
        outputs[f"uv_{k}"] = tree.combine(u, v, 0.0)
        outputs[f"weight_{k}"] = powers[k - 1] / norm
    set_outputs(tree, **outputs)


def _sum(tree: Tree, vector: Socket) -> Socket:
    return tree.vector("DOT_PRODUCT", vector, (1.0, 1.0, 1.0))


def _diagonal(tree: Tree, value: Socket) -> Socket:
    return tree.combine(value, value, value)
