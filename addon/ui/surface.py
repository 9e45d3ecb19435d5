# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that lines and marks are drawn on, as arrays; they are lifted off it by LIFT object sizes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.manifold import Manifold

#: Distance between lines and surface, over the object's diagonal.
LIFT = 0.003
#: How near to the surface, over LIFT, a line may come between its points, and how often points join for that.
LOWEST, ROUNDS = 0.4, 5


@dataclass(frozen=True)
class Surface:
    vertices: np.ndarray  #: (n, 3) float64
    triangles: np.ndarray  #: (m, 3) int32
    taken: Manifold | None = None  #: how it was taken from a mesh that is no surface itself

    def vertex_values(self, values: np.ndarray) -> np.ndarray:
        """Of the drawn mesh's vertices → of the surface's."""
        return values if self.taken is None else self.taken.to_surface(values)

    def triangle_values(self, values: np.ndarray) -> np.ndarray:
        """Of the drawn mesh's triangles → of the surface's."""
        return values if self.taken is None else values[self.taken.triangles]

    @cached_property
    def size(self) -> float:
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0))) or 1.0

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """(m, 3) normals of the triangles, twice as long as their areas; of meshes too that are no surface."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return np.cross(b - a, c - a)

    @cached_property
    def neighbours(self) -> np.ndarray:
        """(m, 3) int32 per edge, from corner i to the next: the triangle beyond it; -1 at the border."""
        starts, ends = self.triangles.ravel().astype(np.int64), np.roll(self.triangles, -1, axis=1).ravel()
        keys = np.minimum(starts, ends) * len(self.vertices) + np.maximum(starts, ends)
        order = np.argsort(keys, kind="stable")
        first = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
        beyond = np.full(len(keys), -1, np.int32)
        beyond[order[first]], beyond[order[first + 1]] = order[first + 1] // 3, order[first] // 3
        return beyond.reshape(-1, 3)

    @cached_property
    def normals(self) -> np.ndarray:
        """(n, 3) at the vertices, weighted by area."""
        crossed = np.repeat(self.area_vectors, 3, axis=0)
        owner = self.triangles.ravel()
        count = len(self.vertices)
        normals = np.stack([np.bincount(owner, crossed[:, axis], count) for axis in range(3)], axis=1)
        return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def lifted(
    surface: Surface, faces: np.ndarray, barycentric: np.ndarray, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Positions on these faces, LIFT object sizes above the surface; and the normals there, both (k, 3)."""
    normals = _evaluate(surface, surface.normals, faces, barycentric)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return positions + LIFT * surface.size * normals, normals


def lift(points: np.ndarray, surface: Surface, mesh) -> tuple[np.ndarray, np.ndarray]:
    """Points onto the surface as it is drawn, and LIFT object sizes above it; and the normals there, both (k, 3).

    mesh: its native TriangleMesh, or None where it is no surface: the points then stay where they are."""
    points = np.asarray(points, np.float64)
    if mesh is None or not len(points):
        return points, np.tile((0.0, 0.0, 1.0), (len(points), 1))
    faces, barycentric, _ = mesh.closest_points(points)
    return lifted(surface, faces, barycentric, np.asarray(mesh.positions(faces, barycentric)))


def laid(line: np.ndarray, surface: Surface, mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A polyline lifted off the surface with what lies between its points too: points and normals (k, 3), and where on
    the line they are (k,), 1.5 half-way from the second point to the third. Points join where it would sink in."""
    at = np.arange(len(line), dtype=np.float64)
    points, normals = lift(line, surface, mesh)
    for _ in range(ROUNDS if mesh is not None else 0):
        sunk = np.flatnonzero(_height(0.5 * (points[1:] + points[:-1]), surface, mesh) < LOWEST * LIFT * surface.size)
        if not len(sunk):
            break
        between = 0.5 * (at[sunk] + at[sunk + 1])
        more, more_normals = lift(0.5 * (points[sunk] + points[sunk + 1]), surface, mesh)
        at = np.insert(at, sunk + 1, between)
        points, normals = np.insert(points, sunk + 1, more, axis=0), np.insert(normals, sunk + 1, more_normals, axis=0)
    return points, normals, at


def _height(points: np.ndarray, surface: Surface, mesh) -> np.ndarray:
    """(k,) mesh units above the nearest points of the surface, negative below it."""
    faces, barycentric, away = mesh.closest_points(points)
    towards = points - np.asarray(mesh.positions(faces, barycentric))
    normals = _evaluate(surface, surface.normals, faces, barycentric)
    return away * np.sign(np.einsum("kd,kd->k", towards, normals))


def _evaluate(surface: Surface, values: np.ndarray, faces: np.ndarray, barycentric: np.ndarray) -> np.ndarray:
    """Linear interpolation, enough for a picture."""
    return np.einsum("kc,kcd->kd", barycentric, values[surface.triangles[faces]])
