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
    # Points of one cut face as whole multiples of its corners; shared ones are found by their exact coordinates.
    steps = [(i, j, cuts - i - j) for i in range(cuts + 1) for j in range(cuts + 1 - i)]
    number = {(i, j): n for n, (i, j, _) in enumerate(steps)}
    weights = np.array(steps)
    small = [
        triple
        for i in range(cuts)
        for j in range(cuts - i)
        for triple in (
            [((i, j), (i + 1, j), (i, j + 1))]
            + ([((i + 1, j), (i + 1, j + 1), (i, j + 1))] if i + j < cuts - 1 else [])
        )
    ]
    local = np.array([[number[corner] for corner in triple] for triple in small])
    keys, faces_of = [], []
    for face, triangle in enumerate(triangles):
        key = np.zeros((len(steps), 12), np.int64)
        key[:, triangle] = weights
        keys.append(key)
        faces_of.append(local + face * len(steps))
    unique, inverse = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    points = unique @ corners
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    faces_found = inverse.ravel()[np.concatenate(faces_of)]
    a, b, c = (points[faces_found[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces_found[inward] = faces_found[inward][:, [0, 2, 1]]
    return MeshData(points, faces_found.astype(np.int32))


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
