# SPDX-License-Identifier: GPL-3.0-or-later
"""Which faces of a triangle soup continue each other: pairs of halfedges, fans of corners, connected pieces.

Halfedge 3 f + k runs from corner k of triangle f to the next. `mates` (3 m,) holds the halfedge across, or -1.
"""

import math

import numpy as np

#: A pair of faces that are oriented against each other is taken only where others bend by so much more, in radians.
AGAINST = 2.0


def after(halfedges: np.ndarray) -> np.ndarray:
    """The next halfedge of the same face."""
    return np.where(halfedges % 3 == 2, halfedges - 2, halfedges + 1)


def shared_edges(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """mates across edges that faces share, and the vertices of edges with more than two faces."""
    mates = np.full(triangles.size, -1)
    tails = triangles.ravel()
    crowded: list[int] = []
    all_halfedges = np.arange(triangles.size)
    twos, more = _groups(tails, tails[after(all_halfedges)], all_halfedges, len(points))
    mates[twos[:, 0]], mates[twos[:, 1]] = twos[:, 1], twos[:, 0]
    for group in more:
        crowded += [int(tails[group[0]]), int(tails[after(group[:1])[0]])]
        for one, other in _best_pairs(points, triangles, group):
            mates[one], mates[other] = other, one
    return mates, np.unique(np.array(crowded, np.int64))


def glue_borders(points: np.ndarray, near: np.ndarray, triangles: np.ndarray, mates: np.ndarray) -> None:
    """Pair the halfedges of borders that lie on each other. near: (m, 3) vertices where those in one place are one."""
    tails = near.ravel()
    border = np.flatnonzero(mates < 0)
    if not len(border) or np.array_equal(near, triangles):
        return
    twos, more = _groups(tails, tails[after(border)], border, len(points))
    opposite = tails[twos[:, 0]] == tails[after(twos[:, 1])]
    apex = [tails[after(after(side))] for side in twos.T]
    for one, other in twos[opposite & (apex[0] != apex[1])]:
        mates[one], mates[other] = other, one
    for group in more:
        for one, other in _best_pairs(points, triangles, group):
            if tails[one] == tails[after(np.array([other]))[0]]:
                mates[one], mates[other] = other, one


def fans(triangles: np.ndarray, mates: np.ndarray) -> np.ndarray:
    """(3 m,) a number for each corner, the same for all that are joined around a vertex by pairs of faces."""
    one = np.flatnonzero(mates > np.arange(len(mates)))
    other = mates[one]
    tails = triangles.ravel()
    # Flipped faces run the same way along their edge.
    same_way = tails[one] == tails[other]
    same_way &= tails[after(one)] == tails[after(other)]
    first = np.where(same_way, other, after(other))
    second = np.where(same_way, after(other), other)
    return connected(len(mates), np.concatenate([one, after(one)]), np.concatenate([first, second]))


def pieces(faces: int, mates: np.ndarray) -> np.ndarray:
    """(m,) a number for each face, the same for all that hang together."""
    one = np.flatnonzero(mates > np.arange(len(mates)))
    return connected(faces, one // 3, mates[one] // 3)


def connected(count: int, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(count,) for each item the least of those that links join it to."""
    label = np.arange(count)
    while True:
        least = np.minimum(label[one], label[other])
        before = label.copy()
        np.minimum.at(label, label[one], least)  # at the roots, so that whole groups move at once
        np.minimum.at(label, label[other], least)
        np.minimum.at(label, one, least)
        np.minimum.at(label, other, least)
        label = label[label]
        if np.array_equal(label, before):
            return label


def _groups(tails, heads, halfedges: np.ndarray, count: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Of these halfedges with their heads: (p, 2) those that share an edge with one other, and groups of more."""
    ends = np.sort(np.stack([tails[halfedges], heads]), axis=0).astype(np.int64)
    key = ends[0] * count + ends[1]
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.r_[True, key[order][1:] != key[order][:-1]])
    sizes = np.diff(np.r_[starts, len(key)])
    twos = halfedges[order[starts[sizes == 2][:, None] + np.arange(2)]]
    big = zip(starts[sizes > 2], sizes[sizes > 2], strict=True)
    return twos.reshape(-1, 2), [halfedges[order[start : start + size]] for start, size in big]


def _best_pairs(points: np.ndarray, triangles: np.ndarray, group: np.ndarray) -> list[tuple[int, int]]:
    """Of the faces around one edge those that continue each other: the straightest pair first."""
    tails = triangles.ravel()
    start, end = points[tails[group[0]]], points[tails[after(group[:1])[0]]]
    axis = (end - start) / (np.linalg.norm(end - start) or 1.0)
    apex = points[tails[after(after(group))]] - start
    away = apex - np.outer(apex @ axis, axis)
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-300)
    along = (points[tails[after(group)]] - points[tails[group]]) @ axis > 0
    costs = []
    for i in range(len(group)):
        for j in range(i + 1, len(group)):
            bend = math.pi - math.acos(max(-1.0, min(1.0, float(away[i] @ away[j]))))
            if bend < math.pi - 1e-6:  # faces that lie on each other do not continue each other
                costs.append((round(bend + AGAINST * (along[i] == along[j]), 9), i, j))
    free, pairs = set(range(len(group))), []
    for _cost, i, j in sorted(costs):
        if i in free and j in free:
            free -= {i, j}
            pairs.append((int(group[i]), int(group[j])))
    return pairs
