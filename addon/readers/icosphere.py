# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere of nearly equal triangles: the icosahedron, each face cut into k × k."""

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData

MAX_FACES = 20_000_000


def icosphere(faces: int) -> MeshData:
    """The unit sphere with 20 k² faces, k such that this is closest to `faces`; counter-clockwise from outside."""
    if not 20 <= faces <= MAX_FACES:
        raise InputError(f"a sphere of {faces} faces; choose 20 to {MAX_FACES}")
    low = int(np.sqrt(faces / 20))
    cuts = min((low, low + 1), key=lambda k: abs(20 * k * k - faces))
    corners, triangles = _icosahedron()
    weights, local = _cut(cuts)
    keys, faces_of = [], []
    for face, triangle in enumerate(triangles):
        key = np.zeros((len(weights), 12), np.int64)
        key[:, triangle] = weights
        # Points are found again by their exact coordinates: six whole numbers up to `cuts` in one.
        keys.append(np.stack([key[:, :6] @ _digits(cuts), key[:, 6:] @ _digits(cuts)]))
        faces_of.append(local + face * len(weights))
    high, low = np.concatenate(keys, axis=1)
    order = np.lexsort((low, high))
    new = np.append(True, (np.diff(high[order]) != 0) | (np.diff(low[order]) != 0))
    inverse = np.empty(len(order), np.int64)
    inverse[order] = np.cumsum(new) - 1
    unique = np.stack([(part[order[new]][:, None] // _digits(cuts)) % (cuts + 1) for part in (high, low)], axis=1)
    unique = unique.reshape(-1, 12)
    points = unique @ corners
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    faces_found = inverse[np.concatenate(faces_of)]
    a, b, c = (points[faces_found[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces_found[inward] = faces_found[inward][:, [0, 2, 1]]
    return MeshData(points, faces_found.astype(np.int32))


def _digits(cuts: int) -> np.ndarray:
    """Powers that make one number of six from 0 to `cuts`; MAX_FACES keeps it below 2^63."""
    return (cuts + 1) ** np.arange(5, -1, -1, dtype=np.int64)


def _cut(cuts: int) -> tuple[np.ndarray, np.ndarray]:
    """One face cut into cuts × cuts: its points as whole multiples (p, 3) of its corners, and its triangles."""
    i, j = np.nonzero(np.add.outer(np.arange(cuts + 1), np.arange(cuts + 1)) <= cuts)
    number = np.full((cuts + 2, cuts + 2), -1)
    number[i, j] = np.arange(len(i))
    upright = i + j < cuts
    a, b = i[upright], j[upright]
    first = np.stack([number[a, b], number[a + 1, b], number[a, b + 1]], axis=1)
    second = np.stack([number[a + 1, b], number[a + 1, b + 1], number[a, b + 1]], axis=1)
    both = np.stack([first, second], axis=1).reshape(-1, 3)
    return np.stack([i, j, cuts - i - j], axis=1), both[(both >= 0).all(axis=1)]


def _icosahedron() -> tuple[np.ndarray, np.ndarray]:
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    corners = np.array(
        [row for s in (-1, 1) for t in (-golden, golden) for row in ((0, s, t), (s, t, 0), (t, 0, s))], np.float64
    )
    distance = np.linalg.norm(corners[:, None] - corners, axis=2)
    near = np.isclose(distance, 2.0)
    triangles = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    return corners, np.array(triangles)
