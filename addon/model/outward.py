# SPDX-License-Identifier: GPL-3.0-or-later
"""Which side of a surface is outside: that to which the normals of its closed parts point, or should."""

import numpy as np

from .cutting import after, pieces


def inward(points: np.ndarray, triangles: np.ndarray, mates: np.ndarray) -> np.ndarray:
    """(m,) whether a triangle belongs to a closed part that is inside out.

    The wall of a cavity has negative volume too, and is right: it lies inside a part of positive volume.
    """
    none = np.zeros(len(triangles), bool)
    if (mates < 0).any() and not (mates >= 0).any():
        return none
    piece = pieces(len(triangles), mates)
    closed = np.bincount(piece, (mates.reshape(-1, 3) < 0).any(axis=1), len(triangles)) == 0
    one = np.flatnonzero(mates >= 0)
    tails = triangles.ravel()
    against = (tails[one] == tails[mates[one]]) & (tails[after(one)] == tails[after(mates[one])])
    closed &= np.bincount(piece[one // 3], against, len(triangles)) == 0  # else which side is outside is not known
    volume = np.bincount(piece, _volumes(points, triangles), len(triangles))
    parts = np.unique(piece)
    parts = parts[closed[parts]]
    boxes = {part: _box(points[triangles[piece == part]]) for part in parts[volume[parts] < 0]}
    if not boxes:
        return none
    solid = [(_box(points[triangles[piece == part]]), volume[part]) for part in parts[volume[parts] > 0]]
    wrong = [
        part
        for part, (low, high) in boxes.items()
        if not any((low >= box[0]).all() and (high <= box[1]).all() and size > -volume[part] for box, size in solid)
    ]
    return np.isin(piece, wrong)


def _volumes(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(m,) of the tetrahedra of each triangle and the middle of all, negative where it turns its back to that."""
    used = points[triangles]
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (used - used.mean(axis=(0, 1))).transpose(1, 2, 0)
    return (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0


def _box(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    flat = corners.reshape(-1, 3)
    return flat.min(axis=0), flat.max(axis=0)
