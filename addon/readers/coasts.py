# SPDX-License-Identifier: GPL-3.0-or-later
"""The boundary of a surface in two parts: coasts, where values are missing, and the border, where the data end.

lines = boundary_lines(data.mesh, whole)     # lines.coasts, lines.border; whole: the mesh if no value were missing
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..model.mesh_data import MeshData


@dataclass(frozen=True, eq=False)
class Line:
    """Vertices along a boundary, in order; closed: the last is joined to the first."""

    vertices: np.ndarray
    closed: bool


@dataclass(frozen=True, eq=False)
class Boundary:
    coasts: list[Line]
    border: list[Line]


def boundary_lines(mesh: MeshData, whole: MeshData | None) -> Boundary:
    """The boundary of `mesh`. An edge between two places of the boundary of `whole` is border; without `whole`
    nothing is missing, and all is border."""
    loops = boundary_loops(mesh.triangles)
    if whole is None:
        return Boundary([], [Line(loop, True) for loop in loops])
    outside = boundary_loops(whole.triangles)
    places = whole.vertices[np.concatenate(outside)] if outside else np.zeros((0, 3))
    on_border = np.isin(_keys(mesh.vertices), _keys(places))
    coasts: list[Line] = []
    border: list[Line] = []
    for loop in loops:
        is_border = on_border[loop] & on_border[np.roll(loop, -1)]
        for line, at_border in _runs(loop, is_border):
            (border if at_border else coasts).append(line)
    return Boundary(coasts, border)


def boundary_loops(triangles: np.ndarray) -> list[np.ndarray]:
    """Vertices of every boundary loop of an oriented mesh, in order."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max()) + 1
    back = np.isin(start.astype(np.int64) * count + end, end.astype(np.int64) * count + start)
    after = dict(zip(start[~back].tolist(), end[~back].tolist(), strict=True))
    loops = []
    while after:
        first, vertex = after.popitem()
        loop = [first]
        while vertex != first:
            loop.append(vertex)
            vertex = after.pop(vertex)
        loops.append(np.array(loop))
    return loops


def _runs(loop: np.ndarray, kinds: np.ndarray) -> Sequence[tuple[Line, bool]]:
    """The loop in pieces whose edges are of one kind; kinds: of the edge after each vertex."""
    changes = np.flatnonzero(kinds != np.roll(kinds, 1))
    if not len(changes):
        return [(Line(loop, True), bool(kinds[0]))]
    loop, kinds = np.roll(loop, -changes[0]), np.roll(kinds, -changes[0])
    ends = np.append(changes - changes[0], len(loop))
    closed = np.append(loop, loop[0])
    return [(Line(closed[a : b + 1], False), bool(kinds[a])) for a, b in pairwise(ends)]


def _keys(places: np.ndarray) -> np.ndarray:
    """One value for each place, the same for the same numbers."""
    exact = np.ascontiguousarray(places, np.float64) + 0.0  # -0 is 0
    return exact.view(np.dtype((np.void, exact.dtype.itemsize * 3))).ravel()
