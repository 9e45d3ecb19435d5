# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles without area, and triangles that are there twice.

A polygon with a vertex on one of its sides is cut into triangles of which one has no area. It and its neighbour across
its longest side make two that have.
"""

import numpy as np

from .cutting import connected

#: A triangle is flat when its height is this part of its longest side.
FLAT = 1e-12
#: Vertices of one edge are one when it is this part of the mesh's diagonal.
SHORT = 1e-12


def without_flat(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(n,) the vertex that each became, triangles, their corners in the mesh, and the mesh's triangles without area."""
    flat = is_flat(points, triangles)
    merged = _without_length(points, triangles[flat])
    numbers = np.flatnonzero(flat)
    corners = np.arange(triangles.size).reshape(-1, 3)
    triangles = merged[triangles].astype(np.int64)
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles, corners = triangles[whole], corners[whole]
    if flat[whole].any():
        triangles, corners = _flipped(points, triangles.copy(), corners.copy())
        keep = ~is_flat(points, triangles)
        triangles, corners = triangles[keep], corners[keep]
    return merged, triangles, corners, numbers


def without_repeated(triangles: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each set of corners once, the first, and the mesh's triangles that were left out."""
    keep = np.ones(len(triangles), bool)
    sums = _sums(triangles)
    if len(np.unique(sums)) < len(triangles):  # equal sets have equal sums, different ones hardly ever
        _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
        keep[:] = False
        keep[first] = True
    return triangles[keep], corners[keep], corners[~keep][:, 0] // 3


def _sums(triangles: np.ndarray) -> np.ndarray:
    """(m,) a number for each set of corners, whatever their order: the sum of numbers that are spread over 64 bits."""
    with np.errstate(over="ignore"):
        spread = triangles.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        spread = (spread ^ (spread >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
        return spread[:, 0] + spread[:, 1] + spread[:, 2]


def is_flat(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    longest = np.max([((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) <= FLAT * longest


def _without_length(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n,) for each vertex the first that edges without length of these triangles join it to."""
    if not len(triangles):
        return np.arange(len(points))
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    one, other = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]).T
    short = np.linalg.norm(points[one] - points[other], axis=1) <= SHORT * size
    return connected(len(points), one[short], other[short])


def _flipped(points: np.ndarray, triangles: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Flat triangles exchanged, with the neighbour across the longest side, for two others, where those have area."""
    todo = np.flatnonzero(is_flat(points, triangles)).tolist()
    touched = np.isin(triangles, triangles[todo]).sum(axis=1) >= 2
    faces: dict[frozenset[int], set[int]] = {}
    for face in np.flatnonzero(touched).tolist():
        for edge in _edges(triangles[face]):
            faces.setdefault(edge, set()).add(face)
    for _round in range(len(todo)):
        left = [face for face in todo if not _flip(points, triangles, corners, faces, face)]
        if len(left) == len(todo):
            break
        todo = left
    return triangles, corners


def _flip(points, triangles, corners, faces, face: int) -> bool:
    row = triangles[face]
    sides = [np.linalg.norm(points[row[k]] - points[row[(k + 1) % 3]]) for k in range(3)]
    k = int(np.argmax(sides))
    a, b, c = (row[(k + step) % 3] for step in range(3))
    others = faces.get(frozenset((int(a), int(b))), set()) - {face}
    if len(others) != 1:
        return False
    other = others.pop()
    place = triangles[other].tolist()
    at = next(j for j in range(3) if place[j] not in (a, b))
    x = place[at]
    forward = place[(at + 1) % 3] == b  # the neighbour runs from b to a, as it should
    new = np.array([[a, x, c], [x, b, c]]) if forward else np.array([[a, c, x], [c, b, x]])
    if x == c or is_flat(points, new).any():
        return False
    source = {int(a): corners[face][k], int(b): corners[face][(k + 1) % 3], int(c): corners[face][(k + 2) % 3]}
    source[int(x)] = corners[other][at]
    for index in (face, other):
        for edge in _edges(triangles[index]):
            faces.get(edge, set()).discard(index)
    for index, made in zip((face, other), new, strict=True):
        triangles[index], corners[index] = made, [source[int(vertex)] for vertex in made]
        for edge in _edges(made):
            faces.setdefault(edge, set()).add(index)
    return True


def _edges(row: np.ndarray) -> list[frozenset[int]]:
    a, b, c = map(int, row)
    return [frozenset(pair) for pair in ((a, b), (b, c), (c, a))]
