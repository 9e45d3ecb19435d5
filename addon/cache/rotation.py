# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotation of a vector field: n · (∇ × V) at every vertex, twice the angular speed of the surface there in radians per
second, positive counter-clockwise seen from outside. Materials find storms by it: large in their cores, of the other
sign in the collar around them.

By Stokes' theorem the mean over a face is the circulation around it over its area; a vertex has the mean of its faces.
"""

import numpy as np


def rotation(vertices: np.ndarray, triangles: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """(n,) from vertices (n, 3), triangles (m, 3) and tangent vectors (n, 3) in space; 0 at vertices without faces."""
    corners, flow = vertices[triangles], vectors[triangles]
    circulation = np.zeros(len(triangles))
    for k in range(3):
        after = (k + 1) % 3
        edge = corners[:, after] - corners[:, k]
        circulation += np.einsum("ij,ij->i", flow[:, k] + flow[:, after], edge) / 2
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2

    def gathered(values: np.ndarray) -> np.ndarray:
        return np.bincount(triangles.ravel(), np.repeat(values, 3), minlength=len(vertices))

    around = gathered(area)
    return np.divide(gathered(circulation), around, out=np.zeros(len(vertices)), where=around > 0)
