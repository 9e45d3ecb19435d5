# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotation of a vector field: n · (∇ × V) at every vertex, twice the angular speed of the surface there in radians per
second, positive counter-clockwise seen from outside. Materials find storms by it: it is large in their cores, and has
the other sign in the collar around them.

By Stokes' theorem the mean over a face is the circulation around it over its area; a vertex has the mean of its faces.
"""

from __future__ import annotations

import numpy as np

from .. import native


class Rotation:
    """The rotation of fields on one mesh. What does not depend on the field is computed once."""

    def __init__(self, mesh: native.TriangleMesh) -> None:
        corners = mesh.vertices[mesh.triangles]
        # Each corner's vector counts in both edges that end there: together half of the edge opposite to it.
        opposite = np.stack([corners[:, (k + 1) % 3] - corners[:, (k + 2) % 3] for k in range(3)], axis=1)
        self._edges = opposite.reshape(-1, 9) / 2
        self._corners = mesh.triangles.ravel().astype(np.intp)
        self._count = mesh.vertex_count
        area = self._around_vertices(mesh.face_areas)
        self._per_area = np.divide(1.0, area, out=np.zeros_like(area), where=area > 0)

    def of(self, vectors: np.ndarray) -> np.ndarray:
        """(n,) of tangent vectors (n, 3) in space; 0 at vertices without faces."""
        flow = vectors.take(self._corners, axis=0, mode="clip")
        circulation = np.einsum("mk,mk->m", flow.reshape(-1, 9), self._edges)
        return self._around_vertices(circulation) * self._per_area

    def _around_vertices(self, per_face: np.ndarray) -> np.ndarray:
        return np.bincount(self._corners, np.repeat(per_face, 3), minlength=self._count)
