# SPDX-License-Identifier: GPL-3.0-or-later
"""Border vertices in one place."""

import numpy as np

from .cutting import after, connected

#: Vertices are joined over no more than this part of the shortest border edge, so that no edge vanishes.
OF_EDGE = 0.25


def joined(points: np.ndarray, triangles: np.ndarray, mates: np.ndarray, reach: float) -> np.ndarray:
    """(n,) for each vertex the first border vertex within reach (mesh units), directly or by others between."""
    label = np.arange(len(points))
    border = np.flatnonzero(mates < 0)
    if reach <= 0.0 or not len(border):
        return label
    tails = triangles.ravel()
    ends = np.stack([tails[border], tails[after(border)]])
    length = np.linalg.norm(points[ends[0]] - points[ends[1]], axis=1)
    reach = min(reach, OF_EDGE * float(length.min()))
    vertices = np.unique(ends)
    label[vertices] = vertices[_clusters(points[vertices], reach)]
    return label


def _clusters(points: np.ndarray, reach: float) -> np.ndarray:
    """(c,) for each point the first within reach."""
    grid = (points - points.min(axis=0)) / (2.0 * max(reach, 1e-300))
    ones, others = [], []
    # Two points that are close lie in one cell of at least one of these eight grids.
    for shift in np.ndindex(2, 2, 2):
        cell = np.floor(grid + 0.5 * np.array(shift))
        order = np.lexsort((np.arange(len(cell)), cell[:, 2], cell[:, 1], cell[:, 0]))
        same = (cell[order][1:] == cell[order][:-1]).all(axis=1)
        ones.append(order[:-1][same])
        others.append(order[1:][same])
    one, other = np.concatenate(ones), np.concatenate(others)
    near = np.linalg.norm(points[one] - points[other], axis=1) <= 2.0 * reach
    return connected(len(points), one[near], other[near])
