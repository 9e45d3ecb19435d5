# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing a field over λ inside a region of faces (thesis 11.2.1, 11.2.2).

A pair that the vectors around it do not force is taken away by the smoothest vectors that fit these. What happens at
one λ is made to happen at another by the vectors of that other λ, which fade into those that are there near the border.
"""

from __future__ import annotations

import numpy as np

from .. import native


def grown(mesh: native.TriangleMesh, faces: np.ndarray, rings: int, walls: np.ndarray) -> np.ndarray:
    """Ascending: faces within so many rings around given ones, without the walls."""
    triangles = np.asarray(mesh.triangles)
    blocked = np.zeros(len(triangles), bool)
    blocked[walls] = True
    inside = np.zeros(len(triangles), bool)
    inside[faces] = True
    for _ in range(rings):
        touched = np.zeros(len(mesh.vertices), bool)
        touched[triangles[inside]] = True
        inside |= touched[triangles].any(axis=1) & ~blocked
    return np.flatnonzero(inside & ~blocked).astype(np.int32)


def smoothest(field: native.ParameterizedField, faces: np.ndarray, samples: range) -> np.ndarray:
    """(len(samples), n): with the smoothest vectors inside a region. Raises InputError for a region that has
    none inside, and SolverError."""
    return np.stack([np.asarray(native.smooth_region(field.sample(j), faces).values) for j in samples])


def between(lambdas: np.ndarray, rows: np.ndarray, lam: float) -> np.ndarray:
    """A row of a linear interpolation over λ."""
    j = int(np.clip(np.searchsorted(lambdas, lam, "right") - 1, 0, max(len(lambdas) - 2, 0)))
    if len(lambdas) == 1:
        return rows[0]
    part = (lam - lambdas[j]) / (lambdas[j + 1] - lambdas[j])
    return (1.0 - part) * rows[j] + part * rows[j + 1]


def fade(lambdas: np.ndarray, first: float, last: float, reach: float) -> np.ndarray:
    """1 from the first to the last λ, falling smoothly to 0 within the reach on both sides."""
    away = np.maximum(np.maximum(first - lambdas, lambdas - last), 0.0)
    if reach <= 0.0:
        return (away == 0.0).astype(float)
    return np.where(away < reach, fading(np.minimum(away, reach), reach), 0.0)


def fading(away: np.ndarray | float, reach: float) -> np.ndarray:
    """What is left of a change at a distance in λ: 1 at none, 0 at the reach."""
    return np.cos(0.5 * np.pi * away / reach) ** 2


def shifted(
    mesh: native.TriangleMesh, values: np.ndarray, faces: np.ndarray, weights: np.ndarray, offset: np.ndarray
) -> np.ndarray:
    """(n,) complex128: the vectors that stood back by weight times an offset in space, at the closest point of the
    surface. Vertices of weight 0 keep their bits; so do those that are not inside the region."""
    vertices = np.flatnonzero(weights > 0.0)
    places = np.asarray(mesh.vertices)[vertices] - weights[vertices, None] * offset
    at, barycentric, _ = mesh.closest_points(places)
    space = native.VectorField(mesh, values).to_space()
    corners = np.asarray(mesh.triangles)[at]
    carried = np.einsum("kc,kcd->kd", np.asarray(barycentric), space[corners])
    whole = np.array(space)
    whole[vertices] = carried
    result = values.copy()
    result[vertices] = np.asarray(mesh.to_tangent(whole))[vertices]
    return result


def _boundary(triangles: np.ndarray) -> np.ndarray:
    """Vertices of edges that have one face."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    pairs, counts = np.unique(edges, axis=0, return_counts=True)
    return np.unique(pairs[counts == 1])


def inner_weights(mesh: native.TriangleMesh, faces: np.ndarray, core: np.ndarray, width: float) -> np.ndarray:
    """(n,): 1 near the core, falling to 0 within a width (mesh units); 0 on the region's border and beyond."""
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    outside = np.ones(len(triangles), bool)
    outside[faces] = False
    free = np.zeros(len(vertices), bool)
    free[triangles[faces]] = True
    free[triangles[outside]] = False
    free[_boundary(triangles)] = False
    distance = np.full(len(vertices), np.inf)
    chosen = np.flatnonzero(free)
    for part in np.array_split(chosen, max(1, len(chosen) // 500)):
        distance[part] = np.linalg.norm(vertices[part, None] - core[None], axis=2).min(axis=1)
    part = np.clip(distance / width, 0.0, 1.0)
    return np.where(free, (1.0 - part * part) ** 2, 0.0)
