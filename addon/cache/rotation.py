# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotation of a vector field: n · (∇ × V) at every vertex, twice the angular speed of the surface there in radians per
second, positive counter-clockwise seen from outside. Materials find storms by it: it is large in their cores, and has
the other sign in the collar around them.

By Stokes' theorem the mean over a face is the circulation around it over its area; a vertex has the mean of its faces.
"""

from __future__ import annotations

import numpy as np

from .. import native


def rotation(mesh: native.TriangleMesh, vectors: np.ndarray) -> np.ndarray:
    """(n,) of tangent vectors (n, 3) in space; 0 at vertices without faces."""
    triangles = mesh.triangles
    corners, flow = mesh.vertices[triangles], vectors[triangles]
    circulation = np.zeros(len(triangles))
    for k in range(3):
        after = (k + 1) % 3
        edge = corners[:, after] - corners[:, k]
        circulation += np.einsum("ij,ij->i", flow[:, k] + flow[:, after], edge) / 2
    count = mesh.vertex_count

    def around_vertices(per_face: np.ndarray) -> np.ndarray:
        return np.bincount(triangles.ravel(), np.repeat(per_face, 3), minlength=count)

    area = around_vertices(mesh.face_areas)
    return np.divide(around_vertices(circulation), area, out=np.zeros(count), where=area > 0)
