# SPDX-License-Identifier: GPL-3.0-or-later
"""Where curves begin: points spread evenly over a surface, vertices, rings around points; and the normals there. No
Blender here.

`surface` is a native TriangleMesh; seeds are (faces (k,) int32, barycentric (k, 3) float64).
"""

from __future__ import annotations

import numpy as np

from .. import native
from ..model.errors import InputError

Seeds = tuple[np.ndarray, np.ndarray]

#: Candidates for each point that is kept, and the largest number of points that are spread evenly.
CANDIDATES, MAX_EVEN = 12, 3000


def even_seeds(surface: native.TriangleMesh, count: int, seed: int = 0) -> Seeds:
    """`count` random points, each as far as it can be from those before (up to MAX_EVEN; further ones are random)."""
    random = np.random.default_rng(seed)
    areas = surface.face_areas
    total = max(CANDIDATES * min(count, MAX_EVEN), count)
    faces = random.choice(len(areas), total, p=areas / areas.sum()).astype(np.int32)
    barycentric = random.dirichlet([1.0, 1.0, 1.0], total)
    points = surface.positions(faces, barycentric)
    kept, distance = [], np.full(total, np.inf)
    for _ in range(min(count, MAX_EVEN)):
        farthest = int(np.argmax(distance))
        kept.append(farthest)
        distance = np.minimum(distance, ((points - points[farthest]) ** 2).sum(axis=1))
        distance[farthest] = -1.0
    others = np.setdiff1d(np.arange(total), kept)[: count - len(kept)]
    chosen = np.concatenate([np.array(kept, np.int64), others]) if count > MAX_EVEN else np.array(kept, np.int64)
    return faces[chosen], barycentric[chosen]


def vertex_seeds(surface: native.TriangleMesh, vertices: np.ndarray) -> Seeds:
    """The given vertices. Raises InputError for one that no face uses."""
    corner = np.full(len(surface.vertices), -1, np.int64)
    flat = surface.triangles.ravel()
    corner[flat[::-1]] = np.arange(len(flat))[::-1]
    found = corner[vertices]
    if (found < 0).any():
        raise InputError(f"vertex {int(vertices[found < 0][0])} belongs to no face; choose vertices of the surface")
    barycentric = np.zeros((len(found), 3))
    barycentric[np.arange(len(found)), found % 3] = 1.0
    return (found // 3).astype(np.int32), barycentric


def rings(surface: native.TriangleMesh, seeds: Seeds, radius: float, count: int = 24) -> list[Seeds]:
    """A closed curve on the surface around each seed: a circle in its face's plane, projected to the closest points."""
    centers = surface.positions(*seeds)
    faces = seeds[0]
    x = surface.vertices[surface.triangles[faces, 1]] - surface.vertices[surface.triangles[faces, 0]]
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(surface.face_normals[faces], x)
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    circles = centers[:, None] + radius * (
        np.cos(angle)[None, :, None] * x[:, None] + np.sin(angle)[None, :, None] * y[:, None]
    )
    found, barycentric = surface.closest_points(circles.reshape(-1, 3))[:2]
    around = [np.r_[i * count : (i + 1) * count, i * count] for i in range(len(centers))]
    return [(found[ring], barycentric[ring]) for ring in around]


def normals_at(surface: native.TriangleMesh, faces: np.ndarray, barycentric: np.ndarray) -> np.ndarray:
    """(k, 3) unit vectors: the vertices' normals, linear between them."""
    normals = (surface.normals[surface.triangles[faces]] * barycentric[:, :, None]).sum(axis=1)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
