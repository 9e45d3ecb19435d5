# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of triangles and vertices, how much of a field is tangent, and vectors of faces carried to vertices.

Nothing here needs faces that are turned alike: around a vertex the normals of its faces are turned to agree first.
"""

import numpy as np


def area_vectors(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(m, 3): across each triangle, as long as twice its area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n, 3) unit, the mean of the faces around by area; zero where there is no face."""
    across = area_vectors(points, triangles)
    reference = np.zeros_like(points, dtype=np.float64)
    for k in range(3):
        reference[triangles[:, k]] = across
    total = np.zeros_like(reference)
    for k in range(3):
        corner = triangles[:, k]
        turned = np.where(np.einsum("ij,ij->i", across, reference[corner]) < 0.0, -1.0, 1.0)
        _add(total, corner, across * turned[:, None])
    return _unit(total)


def tangent_share(points: np.ndarray, triangles: np.ndarray, vectors: np.ndarray) -> float | None:
    """Median over the vertices of the length of the tangent part over the length; None where all vectors are zero."""
    normals, length = vertex_normals(points, triangles), np.linalg.norm(vectors, axis=1)
    counted = (length > 1e-9 * length.max(initial=0.0)) & (np.abs(normals).sum(axis=1) > 0.0)
    if not counted.any():
        return None
    unit = vectors[counted] / length[counted, None]
    across = np.einsum("ij,ij->i", unit, normals[counted])[:, None] * normals[counted]
    return float(np.median(np.linalg.norm(unit - across, axis=1)))


def faces_to_vertices(points: np.ndarray, triangles: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """(n, 3): the mean by area of the vectors of the faces around, each turned as its face turns into the tangent plane
    of the vertex, so that tangent vectors keep their lengths."""
    across, normals = area_vectors(points, triangles), vertex_normals(points, triangles)
    area, unit = np.linalg.norm(across, axis=1), _unit(across)
    total, weight = np.zeros((len(points), 3)), np.zeros((len(points), 1))
    for k in range(3):
        corner = triangles[:, k]
        turned = rotated(vectors, unit, normals[corner])
        _add(total, corner, turned * area[:, None])
        _add(weight, corner, area[:, None])
    return np.divide(total, weight, out=np.zeros_like(total), where=weight > 0.0)


def rotated(vectors: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Vectors turned by the smallest rotation that takes the planes across unit `before` to those across `after`."""
    facing = np.where(np.einsum("ij,ij->i", before, after) < 0.0, -1.0, 1.0)[:, None]
    before = before * facing
    cosine = np.einsum("ij,ij->i", before, after)[:, None]
    axis = np.cross(before, after)
    return (
        vectors * cosine
        + np.cross(axis, vectors)
        + axis * (np.einsum("ij,ij->i", axis, vectors)[:, None] / (1.0 + cosine))
    )


def _add(total: np.ndarray, rows: np.ndarray, values: np.ndarray) -> None:
    """total[rows] += values, also where a row comes twice."""
    for k in range(total.shape[1]):
        total[:, k] += np.bincount(rows, values[:, k], minlength=len(total))


def _unit(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors, dtype=np.float64), where=length > 0.0)
