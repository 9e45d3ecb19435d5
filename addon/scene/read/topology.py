# SPDX-License-Identifier: GPL-3.0-or-later
"""Which mesh a cache belongs to: digests of a mesh's connectivity and of its shape, kept with the cache file.

A cache brings one vector per vertex. On a mesh with other connectivity, even with as many vertices, these vectors mean
nothing; on a mesh that was only moved they still lie near where they belong.
"""

import enum
import hashlib

import bpy
import numpy as np

from .mesh import corner_vertices

#: Custom properties of a cache file.
CONNECTIVITY, SHAPE, PLACES = "stormfield_connectivity", "stormfield_shape", "stormfield_places"


class Fit(enum.Enum):
    """How a mesh fits the one that a cache was made for."""

    SAME = "the same mesh"
    MOVED = "its vertices were moved"
    OTHER = "its faces are others"


def remember_mesh(cache_file: bpy.types.CacheFile, mesh: bpy.types.Mesh) -> None:
    """Keep with a cache that it was made for this mesh."""
    points = _points(mesh)
    cache_file[CONNECTIVITY] = connectivity(mesh)
    cache_file[SHAPE], cache_file[PLACES] = _digest(points), _digest(_in_any_order(points))


def fit(cache_file: bpy.types.CacheFile, mesh: bpy.types.Mesh) -> Fit:
    """SAME for a cache of an earlier version, which does not say."""
    known = cache_file.get(CONNECTIVITY)
    if known is None:
        return Fit.SAME
    if known != connectivity(mesh):
        return Fit.OTHER
    points = _points(mesh)
    if cache_file.get(SHAPE) == _digest(points):
        return Fit.SAME
    # The same places in another order: a regular mesh that was sorted into itself.
    return Fit.OTHER if cache_file.get(PLACES) == _digest(_in_any_order(points)) else Fit.MOVED


def connectivity(mesh: bpy.types.Mesh) -> str:
    """Digest of which vertices each face joins, as Object Mode has them. Flipped faces are the same."""
    corners = corner_vertices(mesh)
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    faces = np.add.reduceat(_mixed(corners.astype(np.uint64)), starts) if len(starts) else starts
    return _digest(np.array([len(mesh.vertices), len(corners)], np.int64), faces)


def _points(mesh: bpy.types.Mesh) -> np.ndarray:
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def _in_any_order(points: np.ndarray) -> np.ndarray:
    """A number that the order of the rows does not change."""
    bits = (points + np.float32(0.0)).view(np.uint32).astype(np.uint64)  # + 0: minus zero is zero
    rows = _mixed(bits[:, 0]) + _mixed(bits[:, 1] + np.uint64(1 << 32)) + _mixed(bits[:, 2] + np.uint64(2 << 32))
    return np.array([_mixed(rows).sum(dtype=np.uint64)])


def _mixed(numbers: np.ndarray) -> np.ndarray:
    """Numbers that look random, one for each (splitmix64), so that their sums differ where the numbers do."""
    with np.errstate(over="ignore"):
        z = numbers * np.uint64(0x9E3779B97F4A7C15) + np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def _digest(*arrays: np.ndarray) -> str:
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
