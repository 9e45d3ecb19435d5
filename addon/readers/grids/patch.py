# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of rows and columns that are their own mesh: regions, curvilinear grids, grids in a plane.

Every cell whose four corners have values becomes two triangles, cut along the shorter diagonal; one with three becomes
one triangle. So coasts and the border of the grid are the boundary of the surface.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from .surface import Resolution, Surface, eastward, northward, on_sphere, once, outward, trimmed, upward

#: Places nearer than this on the unit sphere are one: grids repeat columns and fold rows. Some tens of metres.
SAME_PLACE = 1e-5


@dataclass(frozen=True, eq=False)
class Patch:
    """latitude, longitude (a, b) in degrees, NaN where there is no place. turn: (a, b) angle in radians from east to
    the direction of the first component, None where that is east."""

    latitude: np.ndarray
    longitude: np.ndarray
    dims: tuple[str, str]
    turn: np.ndarray | None = None
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int, int]:
        return self.latitude.shape  # type: ignore[return-value]

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        placed = np.isfinite(self.latitude) & np.isfinite(self.longitude)
        latitude, longitude = (np.where(placed, values, 0.0) for values in (self.latitude, self.longitude))
        points = on_sphere(latitude, longitude).reshape(-1, 3)
        usable = (valid & placed).ravel()
        same = welded(points, usable)
        cells = same[_closed(points, self.shape)]
        triangles = once(outward(points, _triangles(points, usable, once(cells)))[0])
        mesh, old, split = trimmed(points, triangles)
        east, north = eastward(longitude).reshape(-1, 3)[old], northward(latitude, longitude).reshape(-1, 3)[old]
        if self.turn is not None:
            cosine, sine = np.cos(self.turn).ravel()[old, None], np.sin(self.turn).ravel()[old, None]
            east, north = cosine * east + sine * north, cosine * north - sine * east

        def vectors(u: np.ndarray, v: np.ndarray) -> np.ndarray:
            return (
                np.asarray(u, np.float64).ravel()[old, None] * east
                + np.asarray(v, np.float64).ravel()[old, None] * north
            )

        changes = {
            "grid points without value, where the surface ends": int((~valid | ~placed).sum()),
            "repeated grid points welded": int((same[usable] != np.flatnonzero(usable)).sum()),
            "corners of coasts split": split,
        }
        notes = (*self.notes, f"the grid of {' × '.join(map(str, self.shape))} points is the mesh")
        if size.faces is not None:
            notes = (*notes, "--sphere-faces counts for grids of the whole globe only")
        return Surface(mesh, vectors, True, changes, notes)


@dataclass(frozen=True, eq=False)
class Plane:
    """x (b,) and y (a,) in one unit of length; arrays (a, b)."""

    x: np.ndarray
    y: np.ndarray
    dims: tuple[str, str]
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.y), len(self.x)

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        x, y = np.meshgrid(self.x, self.y)
        points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
        index = np.arange(x.size).reshape(self.shape)
        triangles = _triangles(points, valid.ravel(), _cells(index))
        mesh, old, split = trimmed(points, upward(points, triangles)[0])

        def vectors(u: np.ndarray, v: np.ndarray) -> np.ndarray:
            u, v = (np.asarray(values, np.float64).ravel()[old] for values in (u, v))
            return np.column_stack([u, v, np.zeros(len(old))])

        changes = {
            "grid points without value, where the surface ends": int((~valid).sum()),
            "corners of coasts split": split,
        }
        return Surface(
            mesh, vectors, False, changes, (*self.notes, f"a plane of {self.shape[0]} × {self.shape[1]} points")
        )


def direction_of_rows(latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """(a, b) angle in radians from east to the direction in which the columns grow."""
    points = on_sphere(latitude, longitude)
    along = np.gradient(points, axis=1)
    return np.arctan2(
        np.einsum("abk,abk->ab", along, northward(latitude, longitude)),
        np.einsum("abk,abk->ab", along, eastward(longitude)),
    )


def _closed(points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """The four corners of every cell; the last column joins the first where it lies as near as a neighbour."""
    index = np.arange(shape[0] * shape[1]).reshape(shape)
    place = points.reshape(*shape, 3)
    step = np.linalg.norm(np.diff(place, axis=1), axis=2)
    gap = np.linalg.norm(place[:, -1] - place[:, 0], axis=1)
    if shape[1] > 2 and np.nanmedian(gap) <= 1.5 * np.nanmedian(step):
        index = np.concatenate([index, index[:, :1]], axis=1)
    return _cells(index)


def _cells(index: np.ndarray) -> np.ndarray:
    """(m, 4) the corners of every cell, around it."""
    corners = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    return np.stack([corner.ravel() for corner in corners], axis=1)


def _triangles(points: np.ndarray, usable: np.ndarray, cells: np.ndarray) -> np.ndarray:
    a, b, c, d = cells.T
    valid = np.stack([usable[corner] for corner in (a, b, c, d)])
    four = valid.all(axis=0)
    across = np.linalg.norm(points[a] - points[c], axis=1) <= np.linalg.norm(points[b] - points[d], axis=1) * (1 + 1e-9)
    first, second = four & across, four & ~across
    parts = [
        np.column_stack([a, b, c])[first],
        np.column_stack([a, c, d])[first],
        np.column_stack([a, b, d])[second],
        np.column_stack([b, c, d])[second],
    ]
    three = valid.sum(axis=0) == 3
    for missing, rest in ((0, (b, c, d)), (1, (a, c, d)), (2, (a, b, d)), (3, (a, b, c))):
        parts.append(np.column_stack(rest)[three & ~valid[missing]])
    return np.concatenate(parts)


def welded(points: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """(n,) for each point of the unit sphere the first usable one in the same place."""
    same = np.arange(len(points))
    places = np.flatnonzero(usable)
    # A border between cells may separate a pair, but not in all of these roundings.
    for shift in itertools.product((0.0, 0.5), repeat=3):
        cells = np.floor((points[places] + 1.0) / (2.0 * SAME_PLACE) + shift).astype(np.int64)
        _, first, inverse = np.unique(cells @ [1 << 40, 1 << 20, 1], return_index=True, return_inverse=True)
        same[places] = np.minimum(same[places], same[places[first[inverse.ravel()]]])
    while not np.array_equal(same, same[same]):
        same = same[same]
    return same
