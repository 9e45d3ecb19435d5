# SPDX-License-Identifier: GPL-3.0-or-later
"""A finer mesh of the same surface, for solves on meshes that are too coarse for what is drawn on them.

Each triangle becomes four by the midpoints of its edges, as often as it takes. The first vertices are those of the
given mesh, so that what is solved is carried back by leaving the others out.
"""

import math

import numpy as np

from .errors import InputError
from .mesh_data import MeshData

#: Most triangles that a mesh is refined to.
MAX_TRIANGLES = 4_000_000


def refined(mesh: MeshData, edge: float) -> MeshData:
    """The mesh with no edge longer than `edge` (mesh units), itself for 0. Raises InputError: too many faces."""
    if edge <= 0.0 or mesh.triangles.max() >= len(mesh.vertices) or not np.isfinite(mesh.vertices).all():
        return mesh  # the core names what is wrong
    sides = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    longest = float(np.linalg.norm(mesh.vertices[sides[:, 0]] - mesh.vertices[sides[:, 1]], axis=1).max())
    if longest <= edge:
        return mesh
    times = math.ceil(math.log2(longest / edge))
    faces = len(mesh.triangles) * 4**times
    if faces > MAX_TRIANGLES:
        raise InputError(
            f"edges of {edge:g} make {faces:,} triangles of this mesh, whose longest edge is {longest:.3g}; "
            "solve on longer edges, or divide the long ones first"
        )
    vertices, triangles = mesh.vertices, mesh.triangles.astype(np.int64)
    for _ in range(times):
        vertices, triangles = _halved(vertices, triangles)
    return MeshData(vertices, triangles)


def _halved(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    keys, which = np.unique(sides[:, 0] * len(vertices) + sides[:, 1], return_inverse=True)
    first, second = keys // len(vertices), keys % len(vertices)
    ab, bc, ca = (which.reshape(-1, 3) + len(vertices)).T
    a, b, c = triangles.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    middles = 0.5 * (vertices[first] + vertices[second])
    return np.concatenate([vertices, middles]), np.stack([np.stack(part, axis=1) for part in parts], axis=1).reshape(
        -1, 3
    )
