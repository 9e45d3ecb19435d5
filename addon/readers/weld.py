# SPDX-License-Identifier: GPL-3.0-or-later
"""Joining of points that a file has more than once: one for each cell, along seams of grids, between blocks.

Only points on borders are joined, so that surfaces that touch stay apart. Where the vectors of coincident points
differ, points of separate pieces are joined and their vectors averaged (values that jump between cells); points of one
piece stay apart (a crack).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

#: Points closer than this part of the size of the mesh coincide, but never those farther than this part of an edge.
OF_SIZE, OF_EDGE = 1e-6, 1e-2
#: Vectors of coincident points agree within this part of the largest vector.
AGREEMENT = 1e-3


@dataclass(frozen=True, eq=False)
class Welded:
    """number (n,): of the joined point that each point of the file became, -1 where no face uses it; points; triangles;
    faces (m,): of the file, which triangles come from. The counts are of points of the file."""

    number: np.ndarray
    points: np.ndarray
    triangles: np.ndarray
    faces: np.ndarray
    welded: int
    averaged: int
    apart: int
    unused: int
    degenerate: int

    def mean(self, values: np.ndarray) -> np.ndarray:
        """(n, k) of the points of the file → of the joined points."""
        used = self.number >= 0
        number, count = self.number[used], np.bincount(self.number[used], minlength=len(self.points))
        columns = [np.bincount(number, column[used], minlength=len(self.points)) / count for column in values.T]
        return np.stack(columns, axis=1)

    def changes(self) -> dict[str, int]:
        return {
            "points welded": self.welded,
            "points averaged where cells disagree": self.averaged,
            "coincident points of different vectors left apart": self.apart,
            "points of no face left out": self.unused,
            "faces without area dropped": self.degenerate,
        }


def weld(points: np.ndarray, triangles: np.ndarray, samples: Sequence[np.ndarray]) -> Welded:
    """samples: vectors (n, k) of the points, one or more times; none where vectors belong to cells."""
    near = coincident(points, triangles)
    differing = _differing(near, samples)
    label = np.where(differing[near], np.arange(len(points)), near)
    averaged = np.zeros(len(points), bool)
    if differing.any():
        piece = _pieces(len(points), label[triangles])
        several = _varies(near, piece) & differing
        averaged = several[near] & (np.bincount(near, minlength=len(points)) > 1)[near]
        label = np.where(averaged, near, label)
    corners = label[triangles]
    whole = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    used = _used(points, corners[whole])
    compact = np.cumsum(used) - 1
    number = np.where(used[label], compact[label], -1)
    in_file = _used(points, triangles)
    number[~in_file] = -1
    return Welded(
        number=number,
        points=points[used],
        triangles=compact[corners[whole]],
        faces=np.flatnonzero(whole),
        welded=int((in_file & (label != np.arange(len(points))) & ~averaged).sum()),
        averaged=int((in_file & averaged).sum()),
        apart=int((in_file & differing[near] & ~averaged).sum()),
        unused=int((~in_file).sum()),
        degenerate=int((~whole).sum()),
    )


def coincident(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n,): the smallest number of a point at the same place. Points inside a surface are left alone."""
    sides = [triangles[:, [k, (k + 1) % 3]] for k in range(3)]
    length = np.concatenate([np.linalg.norm(points[side[:, 0]] - points[side[:, 1]], axis=1) for side in sides])
    reach = _tolerance(points, triangles, length)
    ends = np.sort(np.concatenate(sides), axis=1)
    candidate = np.zeros(len(points), bool)
    candidate[ends[length <= reach]] = True
    key = np.sort(ends[:, 0].astype(np.int64) * len(points) + ends[:, 1])
    new = np.concatenate([[True], key[1:] != key[:-1], [True]])
    for end in divmod(key[new[:-1] & new[1:]], len(points)):  # edges of one face alone
        candidate[end] = True
    candidates = np.flatnonzero(candidate)
    label = np.arange(len(points))
    label[candidates] = candidates[_clusters(points[candidates], reach)]
    return label


def _tolerance(points: np.ndarray, triangles: np.ndarray, length: np.ndarray) -> float:
    used = points[_used(points, triangles)]
    size = float(np.linalg.norm(np.ptp(used, axis=0)))
    rounding = 4.0 * float(np.finfo(points.dtype).eps) * float(np.abs(used).max())
    return min(max(OF_SIZE * size, rounding), OF_EDGE * float(np.median(length)))


def _used(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    used = np.zeros(len(points), bool)
    used[triangles] = True
    return used


def _clusters(points: np.ndarray, reach: float) -> np.ndarray:
    """(c,): the first of the points that are within `reach`, directly or by others between."""
    label = np.arange(len(points))
    if reach <= 0.0 or len(points) < 2:
        return label
    grid = (points.astype(np.float64) - points.min(axis=0)) / (2.0 * reach)
    # Two points that are close lie in one cell of at least one of these eight grids.
    shifts = [np.array([x, y, z]) for x in (0.0, 0.5) for y in (0.0, 0.5) for z in (0.0, 0.5)]
    groups = [_cells_of(grid + shift) for shift in shifts]
    before = np.full(len(points), -1)
    while not np.array_equal(before, label):
        before = label.copy()
        for group in groups:
            least = np.full(group.max() + 1, len(points))
            np.minimum.at(least, group, label)
            label = least[group]
    return label


def _cells_of(grid: np.ndarray) -> np.ndarray:
    """(c,): the number of the unit cell of each place."""
    cell = np.floor(grid).astype(np.int64)
    if cell.max() < 1 << 21:
        return np.unique((cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2], return_inverse=True)[1]
    return np.unique(cell, axis=0, return_inverse=True)[1].ravel()


def _differing(near: np.ndarray, samples: Sequence[np.ndarray]) -> np.ndarray:
    """(n,) at the first point of each cluster: whether vectors differ there at any time."""
    differing = np.zeros(len(near), bool)
    shared = np.flatnonzero(np.bincount(near, minlength=len(near))[near] > 1)
    for values in samples:
        largest = float(np.abs(values).max(initial=0.0))
        for column in values[shared].T:
            low, high = np.full(len(near), np.inf), np.full(len(near), -np.inf)
            np.minimum.at(low, near[shared], column)
            np.maximum.at(high, near[shared], column)
            with np.errstate(invalid="ignore"):
                differing |= high - low > AGREEMENT * largest
    return differing


def _pieces(count: int, triangles: np.ndarray) -> np.ndarray:
    """(n,): which connected piece each point belongs to."""
    from igraph import Graph

    edges = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    return np.array(Graph(count, edges).connected_components().membership)


def _varies(near: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """(n,) at the first point of each cluster: whether its points belong to several pieces."""
    low, high = np.full(len(near), len(near)), np.full(len(near), -1)
    np.minimum.at(low, near, piece)
    np.maximum.at(high, near, piece)
    return high > low
