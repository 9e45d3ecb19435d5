# SPDX-License-Identifier: GPL-3.0-or-later
"""Flicker of a field over λ, beside that of linear interpolation between key frames (thesis figure 11.3).

A storm that drifts moves values of the field over the surface, but does not change how much of the surface has which
speed. Linear interpolation does: between two key frames one storm fades out while its ghost fades in, vectors that
oppose each other pass through zero, and it all pulses with the key frames. So flicker is what motion cannot explain:
the distance between the distributions of speed (area-weighted, earth mover's distance) of one sample and the next, in
percent of the mean speed. Beside it: how many fixed points are born or lost on the way.
"""

from __future__ import annotations

import itertools

import numpy as np

QUANTILES = np.linspace(0.0, 1.0, 2001)


def flicker(fields: np.ndarray, weights: np.ndarray) -> float:
    """Percent per step of fields (steps, n, 3) with a weight per vertex."""
    distributions = np.stack([_quantiles(np.linalg.norm(field, axis=1), weights) for field in fields])
    return float(100.0 * np.abs(np.diff(distributions, axis=0)).mean() / distributions.mean())


def topology_changes(mesh, fields: np.ndarray, native) -> int:
    """Fixed points that appear or vanish from one step to the next, added up; mesh: native.TriangleMesh."""
    counts = [
        len(native.fixed_points(native.VectorField.from_space(mesh, field.astype(np.float64)))) for field in fields
    ]
    return int(np.abs(np.diff(counts)).sum())


def interpolated(fields: np.ndarray, keys: int) -> np.ndarray:
    """The same at ``keys`` evenly spread key frames, linear interpolation between them."""
    steps = len(fields)
    at = np.round(np.linspace(0, steps - 1, keys)).astype(int)
    result = np.empty_like(fields)
    for first, last in itertools.pairwise(at):
        share = (np.arange(first, last + 1) - first)[:, None, None] / (last - first)
        result[first : last + 1] = (1 - share) * fields[first] + share * fields[last]
    return result


def vertex_areas(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(triangles.ravel(), np.repeat(area, 3), minlength=len(vertices))


def _quantiles(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    order = np.argsort(values)
    share = np.cumsum(weights[order])
    share = (share - weights[order] / 2) / share[-1]
    return np.interp(QUANTILES, share, values[order])
