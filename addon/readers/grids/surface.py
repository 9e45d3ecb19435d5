# SPDX-License-Identifier: GPL-3.0-or-later
"""A grid as a surface: its triangles, and how components on the grid become vectors at its vertices."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ...model.errors import InputError
from ...model.mesh_data import MeshData


@dataclass(frozen=True)
class Resolution:
    """faces: of the sphere that carries a grid of the whole globe, about; None follows the grid."""

    faces: int | None = None


@dataclass(frozen=True, eq=False)
class Surface:
    """mesh: on the unit sphere (x to 0° E on the equator, y to 90° E, z to the north pole), or in a plane. vectors: (u,
    v) on the grid, missing ones NaN → (n, 3) in space at the vertices. changes, notes: as in Reading."""

    mesh: MeshData
    vectors: Callable[[np.ndarray, np.ndarray], np.ndarray]
    spherical: bool = True
    changes: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


class Grid(Protocol):
    """dims: the horizontal dimensions, in the order of the arrays that its methods take."""

    @property
    def dims(self) -> tuple[str, ...]: ...

    @property
    def shape(self) -> tuple[int, ...]: ...

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        """valid (shape) bool: where no sample misses its value. sample: u and v of the first one."""
        ...


def on_sphere(latitude, longitude) -> np.ndarray:
    """Degrees → (..., 3) on the unit sphere."""
    phi, theta = np.radians(latitude), np.radians(longitude)
    return np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi) + 0.0 * theta], axis=-1)


def eastward(longitude) -> np.ndarray:
    """Degrees → (..., 3), the unit vector to the east."""
    theta = np.radians(longitude)
    return np.stack([-np.sin(theta), np.cos(theta), np.zeros_like(theta)], axis=-1)


def northward(latitude, longitude) -> np.ndarray:
    """Degrees → (..., 3), the unit vector to the north."""
    phi, theta = np.radians(latitude), np.radians(longitude)
    return np.stack([-np.sin(phi) * np.cos(theta), -np.sin(phi) * np.sin(theta), np.cos(phi) + 0.0 * theta], axis=-1)


def trimmed(points: np.ndarray, triangles: np.ndarray) -> tuple[MeshData, np.ndarray, int]:
    """The vertices that faces use, with one for each fan of faces where several meet in a point only: mesh, the old
    vertex of each new one, and how many were added. Raises InputError where no face is left."""
    if not len(triangles):
        raise InputError("no face of the grid has values at all its corners, so that nothing is left to analyze")
    fans, twin_of = _split_fans(len(points), triangles)
    old_of = np.concatenate([np.arange(len(points)), twin_of])
    used = np.unique(fans)
    # In the order of the old vertices, so that nearby ones stay near.
    used = used[np.argsort(old_of[used], kind="stable")]
    number = np.empty(len(old_of), np.int64)
    number[used] = np.arange(len(used))
    return MeshData(points[old_of[used]], number[fans]), old_of[used], len(twin_of)


def _split_fans(count: int, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles whose fans share no vertex that they share no edge at, and the old vertex of each that was added: they
    are numbered from `count`."""
    start, end = triangles, np.roll(triangles, -1, axis=1)
    key = (np.minimum(start, end).astype(np.int64) * count + np.maximum(start, end)).ravel()
    edges, times = np.unique(key, return_counts=True)
    border = edges[times == 1]
    pinched = np.flatnonzero(np.bincount(np.concatenate([border // count, border % count]), minlength=count) > 2)
    if not len(pinched):
        return triangles, np.zeros(0, np.int64)
    result = triangles.copy()
    twins: list[int] = []
    is_pinched = np.zeros(count, bool)
    is_pinched[pinched] = True
    rows, columns = np.nonzero(is_pinched[triangles])
    order = np.argsort(triangles[rows, columns], kind="stable")
    rows, columns = rows[order], columns[order]
    vertices = triangles[rows, columns]
    bounds = np.flatnonzero(np.diff(vertices, prepend=-1, append=count))
    for first, last in itertools.pairwise(bounds):
        for fan in _fans(triangles[rows[first:last]], vertices[first])[1:]:
            result[rows[first:last][fan], columns[first:last][fan]] = count + len(twins)
            twins.append(int(vertices[first]))
    return result, np.asarray(twins, np.int64)


def _fans(around: np.ndarray, vertex: int) -> list[list[int]]:
    """The triangles around a vertex in sets that hang together by edges at it."""
    left = list(range(len(around)))
    fans = []
    while left:
        fan, reach = [], set(around[left[0]]) - {vertex}
        while True:
            more = [i for i in left if reach & (set(around[i]) - {vertex})]
            if not more:
                break
            fan += more
            left = [i for i in left if i not in more]
            reach |= {corner for i in more for corner in around[i]} - {vertex}
        fans.append(fan)
    return fans


def outward(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of a sphere around the origin, counter-clockwise seen from outside, and which of the given they are:
    those with an area."""
    return facing(points, triangles, points[triangles].sum(axis=1) if len(triangles) else np.zeros((0, 3)))


def upward(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the plane z = 0, counter-clockwise seen from above, and which of the given they are."""
    return facing(points, triangles, np.array([0.0, 0.0, 1.0]))


def facing(points: np.ndarray, triangles: np.ndarray, towards: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles whose normals point towards (m, 3) or (3,), and the places of those with an area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    side = (np.cross(b - a, c - a) * towards).sum(axis=1)
    kept = np.flatnonzero((np.diff(np.sort(triangles, axis=1), axis=1) != 0).all(axis=1) & (side != 0.0))
    turned = np.where((side < 0.0)[:, None], triangles[:, [0, 2, 1]], triangles)
    return turned[kept], kept


def once(faces: np.ndarray) -> np.ndarray:
    """(m, k) faces without those whose corners stand there twice."""
    corners = np.sort(faces, axis=1)
    order = np.lexsort(corners.T[::-1])
    new = np.append(True, (np.diff(corners[order], axis=0) != 0).any(axis=1))[: len(faces)]
    return faces[np.sort(order[new])]
