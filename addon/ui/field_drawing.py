# SPDX-License-Identifier: GPL-3.0-or-later
"""Field → points and lines to draw, from the evaluated mesh and its attributes alone. No GPU here, nothing is written.

Places where strokes begin are spread evenly and stay where they are while λ changes, so that scrubbing shows motion of
the field and not of the sampling. All lines and marks are lifted off the surface by LIFT object sizes.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import native

#: Distance between lines and surface, over the object's diagonal.
LIFT = 0.003


@dataclass(frozen=True)
class Surface:
    vertices: np.ndarray  #: (n, 3) float64
    triangles: np.ndarray  #: (m, 3) int32

    @cached_property
    def size(self) -> float:
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0))) or 1.0

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """(m, 3) normals of the triangles, twice as long as their areas; of meshes too that are no surface."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return np.cross(b - a, c - a)

    @cached_property
    def normals(self) -> np.ndarray:
        """(n, 3) at the vertices, weighted by area."""
        crossed = np.repeat(self.area_vectors, 3, axis=0)
        owner = self.triangles.ravel()
        count = len(self.vertices)
        normals = np.stack([np.bincount(owner, crossed[:, axis], count) for axis in range(3)], axis=1)
        return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


@dataclass(frozen=True)
class Seeds:
    faces: np.ndarray  #: (k,) int32
    barycentric: np.ndarray  #: (k, 3)
    spacing: float


def spread_seeds(surface: Surface, density: int) -> Seeds:
    """Evenly spread places: a low-discrepancy sequence by area, thinned to one place per cell of a grid."""
    spacing = float(np.ptp(surface.vertices, axis=0).max()) / density
    areas = 0.5 * np.linalg.norm(surface.area_vectors, axis=1)
    total = areas.sum()
    if total <= 0 or spacing <= 0:
        return Seeds(np.zeros(0, np.int32), np.zeros((0, 3)), spacing)
    count = int(min(60_000, 4 * total / spacing**2 + 16))
    index = np.arange(count)
    along, u, v = ((0.5 + index * step) % 1.0 for step in (0.8191725133961645, 0.6710436067037893, 0.5497004779019703))
    faces = np.searchsorted(np.cumsum(areas) / total, along).clip(max=len(areas) - 1).astype(np.int32)
    root = np.sqrt(u)
    barycentric = np.stack([1 - root, root * (1 - v), root * v], axis=1)
    places = np.einsum("kc,kcd->kd", barycentric, surface.vertices[surface.triangles[faces]])
    cells = np.floor(places / (0.85 * spacing)).astype(np.int64)
    _, first = np.unique(cells, axis=0, return_index=True)
    first.sort()
    return Seeds(faces[first], barycentric[first], spacing)


@dataclass(frozen=True)
class Strokes:
    lines: np.ndarray  #: (l, 2, 3) segments of all strokes, lifted off the surface
    along: np.ndarray  #: (l, 2) 0 at a stroke's tail to 1 at its front
    speed: np.ndarray  #: (l,) speed at the stroke's seed, 1 for what counts as fast


def strokes(surface: Surface, mesh, values: np.ndarray, seeds: Seeds, length: float) -> Strokes:
    """Short streamlines through the seeds, traced by the core on its TriangleMesh `mesh`; slow ones are shorter.

    The field's speed is made even first, so that one duration gives every stroke its length.
    """
    speed = np.linalg.norm(values, axis=1, keepdims=True)
    fast = _fast_speed(values)
    relative = np.minimum(1.0, speed / fast)
    paced = values / np.maximum(speed, 0.02 * fast) * (0.25 + 0.75 * relative)
    field = native.VectorField.from_space(mesh, paced)
    duration = seeds.spacing * length
    traces = native.streamlines(field, seeds.faces, seeds.barycentric, max_time=duration, tolerance=0.1, max_steps=200)
    offsets = np.asarray(traces.offsets)
    points = traces.points + LIFT * surface.size * _evaluate(surface, surface.normals, traces.faces, traces.barycentric)
    owner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    first = np.flatnonzero(owner[:-1] == owner[1:])
    pairs = np.stack([first, first + 1], axis=1)
    at_seed = _evaluate(surface, values, seeds.faces, seeds.barycentric)
    seed_speed = np.minimum(1.0, np.linalg.norm(at_seed, axis=1) / fast)
    return Strokes(points[pairs], np.asarray(traces.times)[pairs] / duration, seed_speed[owner[first]])


def arrows(surface: Surface, values: np.ndarray, seeds: Seeds, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Arrows as lines (k, 3 segments, 2 ends, 3): shaft and two barbs; and their relative speed (k,)."""
    normals = _evaluate(surface, surface.normals, seeds.faces, seeds.barycentric)
    flow = _evaluate(surface, values, seeds.faces, seeds.barycentric)
    speed = np.linalg.norm(flow, axis=1, keepdims=True)
    relative = np.minimum(1.0, speed / _fast_speed(values))
    along = flow / np.maximum(speed, 1e-30) * (seeds.spacing * 0.4 * length * (0.3 + 0.7 * relative))
    aside = np.cross(normals, along)
    start = _positions(surface, seeds.faces, seeds.barycentric) + LIFT * surface.size * normals
    tip = start + along
    barbs = [tip - 0.35 * along + sign * 0.2 * aside for sign in (1, -1)]
    lines = np.stack([np.stack([start, tip], 1), np.stack([barbs[0], tip], 1), np.stack([barbs[1], tip], 1)], axis=1)
    return lines, relative[:, 0]


def lifted(
    surface: Surface, faces: np.ndarray, barycentric: np.ndarray, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Positions on these faces, LIFT object sizes above the surface; and the normals there, both (k, 3)."""
    normals = _evaluate(surface, surface.normals, faces, barycentric)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return positions + LIFT * surface.size * normals, normals


def _fast_speed(values: np.ndarray) -> float:
    """The speed that counts as fast: the 95th percentile, never zero."""
    return max(float(np.percentile(np.linalg.norm(values, axis=1), 95)), 1e-12) if len(values) else 1.0


def _evaluate(surface: Surface, values: np.ndarray, faces: np.ndarray, barycentric: np.ndarray) -> np.ndarray:
    """Linear interpolation, enough for a picture (the fixed points use the core's own interpolation)."""
    return np.einsum("kc,kcd->kd", barycentric, values[surface.triangles[faces]])


def _positions(surface: Surface, faces: np.ndarray, barycentric: np.ndarray) -> np.ndarray:
    return np.einsum("kc,kcd->kd", barycentric, surface.vertices[surface.triangles[faces]])
