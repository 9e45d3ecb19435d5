# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's own faces, with any number of corners."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Polygons:
    """Corners per face, and the vertex of every corner, as Blender stores them."""

    counts: np.ndarray  #: (f,) int32
    indices: np.ndarray  #: (sum of counts,) int32

    @classmethod
    def of_triangles(cls, triangles: np.ndarray) -> "Polygons":
        return cls(np.full(len(triangles), 3, np.int32), np.ascontiguousarray(triangles, np.int32).ravel())

    def of_triangle_values(self, values: np.ndarray) -> np.ndarray:
        """(f,) for each polygon the first value >= 0 of its triangles, which follow each other in the mesh, or -1.

        values: (m,) int32, one per triangle.
        """
        polygon = np.repeat(np.arange(len(self.counts)), self.counts - 2)
        found = np.full(len(self.counts), -1, np.int32)
        inside = np.flatnonzero(values >= 0)[::-1]  # the first triangle is written last
        found[polygon[inside]] = values[inside]
        return found
