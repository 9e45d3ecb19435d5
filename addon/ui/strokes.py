# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of a field: short streamlines through seeds, from samples of the field on a small grid around each seed.

    grids = Grids(surface, mesh, seeds)
    grids.prepare(chosen, reach)        # once: where on the surface the nodes of the grids lie
    drawn = strokes(grids, chosen, values)
    drawn.points[i]                     # (POINTS, 3) from the tail to the front, lifted off the surface

A stroke is as long as a few distances between strokes, on fine meshes many faces. The field and the surface are
therefore taken as biquadratic over 3 × 3 nodes around the seed: 27 vertices for each stroke, whatever the mesh. The
work depends on the number of strokes alone. A picture needs no more; analyses trace through every face.
"""

from dataclasses import dataclass

import numpy as np

from .stroke_seeds import SeedLevels
from .surface import LIFT, Surface

#: Points of one stroke, odd: the seed is in the middle.
POINTS = 13
#: Nodes of a grid, in reaches from the seed along both tangents.
NODES = np.array([(a, b) for b in (-1.0, 0.0, 1.0) for a in (-1.0, 0.0, 1.0)])
#: Places between the nodes where a grid is compared with the surface; how low and high over it a stroke may be there,
#: over LIFT; and how often a grid is halved for that.
BETWEEN = np.array([(a, b) for b in (-0.6, 0.0, 0.6) for a in (-0.6, 0.0, 0.6) if a or b], np.float32)
LOWEST, HIGHEST, HALVINGS = 0.3, 3.0, 3
#: A node whose surface turns its back on the seed's belongs to another sheet: cosine between the normals.
SAME_SHEET = 0.1
#: Below this fraction of what counts as fast there is no field.
NO_FIELD = 1e-6
#: Vertices from which it is told what counts as fast.
SAMPLE = 4096


@dataclass(frozen=True)
class Strokes:
    points: np.ndarray  #: (k, POINTS, 3) float32
    speed: np.ndarray  #: (k,) float32 at the seed, 1 for what counts as fast; 0 where there is no field


class Grids:
    """The nodes around every seed: vertices, weights and places, filled as they are asked for."""

    def __init__(self, surface: Surface, mesh, seeds: SeedLevels) -> None:
        self.surface, self.mesh, self.seeds = surface, mesh, seeds
        self.asked = np.zeros(0)  #: mesh units from the seed to the next nodes that were asked for; 0 before that
        self.reach = np.zeros(0)  #: as far as the surface is simple enough
        self.vertices = np.zeros((0, 9, 3), np.int32)
        self.weights = np.zeros((0, 9, 3), np.float32)
        self.places = np.zeros((0, 9, 3), np.float32)  #: lifted
        self.tangents = np.zeros((0, 2, 3), np.float32)
        self._grow()

    def _grow(self) -> None:
        """Room for seeds that joined."""
        more = len(self.seeds) - len(self.asked)
        if not more:
            return
        for name in ("asked", "reach", "vertices", "weights", "places"):
            array = getattr(self, name)
            setattr(self, name, np.concatenate([array, np.zeros((more, *array.shape[1:]), array.dtype)]))
        fresh = _tangents(self.seeds.normals[-more:]).astype(np.float32)
        self.tangents = np.concatenate([self.tangents, fresh])

    def prepare(self, chosen: np.ndarray, reach: np.ndarray) -> None:
        """chosen: (k,) numbers of seeds; reach: (k,) mesh units. What is there already is kept. Where a grid of that
        size would leave the surface it is made smaller, and the stroke shorter."""
        self._grow()
        missing = np.flatnonzero(self.asked[chosen] != reach)
        which, reach = chosen[missing], reach[missing]
        self.asked[which] = reach
        for _ in range(HALVINGS + 1):
            if not len(which):
                return
            self._lay(which, reach)
            leaves = self._leaves_surface(which)
            which, reach = which[leaves], 0.5 * reach[leaves]

    def _leaves_surface(self, which: np.ndarray) -> np.ndarray:
        """(k,) bool: whether what lies between the nodes sinks into the surface, or floats far above it."""
        if self.mesh is None:
            return np.zeros(len(which), bool)
        nodes = np.ascontiguousarray(self.places[which].transpose(2, 1, 0))[:, :, None, :]
        between = np.broadcast_to(BETWEEN.T[:, :, None], (2, len(BETWEEN), len(which)))
        points = _at(nodes, between).transpose(2, 1, 0).reshape(-1, 3).astype(np.float64)
        _, _, places, normals = self._nearest(points)
        height = np.einsum("kd,kd->k", points - places, normals).reshape(len(which), -1)
        lift = LIFT * self.surface.size
        return ((height < LOWEST * lift) | (height > HIGHEST * lift)).any(axis=1)

    def _lay(self, which: np.ndarray, reach: np.ndarray) -> None:
        """Put the nodes of these grids onto the surface."""
        flat = np.einsum("na,kad->knd", NODES, self.tangents[which]) * reach[:, None, None]
        wanted = (self.seeds.positions[which][:, None] + flat).reshape(-1, 3)
        own = np.repeat(self.seeds.normals[which], 9, axis=0)
        vertices, barycentric, places, normals = self._on_surface(which, wanted, own)
        other = np.einsum("kd,kd->k", normals, own) < SAME_SHEET
        middle = np.repeat(np.arange(len(which)) * 9 + 4, 9)[other]
        vertices[other], barycentric[other] = vertices[middle], barycentric[middle]
        places[other], normals[other] = wanted[other], own[other]
        shape = (len(which), 9, 3)
        lifted = (places + LIFT * self.surface.size * normals).reshape(shape)
        self.vertices[which], self.weights[which] = vertices.reshape(shape), barycentric.reshape(shape)
        self.places[which] = lifted
        self.reach[which] = reach

    def _on_surface(self, which: np.ndarray, wanted: np.ndarray, own: np.ndarray):
        """Vertices, barycentric coordinates, places and normals of the nodes. A mesh that is no surface has no near
        places: there the nodes see the field of their seed, and strokes are straight."""
        if self.mesh is None:
            vertices = np.repeat(self.surface.triangles[self.seeds.faces[which]], 9, axis=0)
            return vertices, np.repeat(self.seeds.barycentric[which], 9, axis=0), wanted, own
        return self._nearest(wanted)

    def _nearest(self, wanted: np.ndarray):
        """Vertices, barycentric coordinates, places and normals of the nearest points of the surface."""
        faces, barycentric, _ = self.mesh.closest_points(wanted)
        vertices = self.surface.triangles[faces]
        normals = np.einsum("kc,kcd->kd", barycentric, self.surface.normals[vertices])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        return vertices, barycentric, np.asarray(self.mesh.positions(faces, barycentric)), normals

    def sampled(self, chosen: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(2, 9, k) float32: the vectors at the nodes, along both tangents of the seed. values: (n, 3) float32."""
        at = np.take(values, self.vertices[chosen].reshape(-1), axis=0).reshape(-1, 9, 3, 3)
        vectors = np.einsum("knc,kncd->knd", self.weights[chosen], at)
        return np.ascontiguousarray(np.einsum("knd,kad->ank", vectors, self.tangents[chosen]))


def strokes(grids: Grids, chosen: np.ndarray, values: np.ndarray) -> Strokes:
    """In fast flow from one side of the grid to the other; slower ones are shorter. values: (n, 3) float32."""
    field, fast = grids.sampled(chosen, values), fast_speed(values)
    half = (POINTS - 1) // 2
    step = np.float32(1.0 / half)
    at_seed = np.hypot(field[0, 4], field[1, 4])
    track = np.empty((POINTS, 2, len(chosen)), np.float32)
    track[half] = 0.0
    both = np.concatenate([field, field], axis=2)
    sign = np.repeat(np.array([1.0, -1.0], np.float32), len(chosen)) * step
    place = np.zeros((2, 2 * len(chosen)), np.float32)
    pace = sign * _pace(_at(both, place), fast)
    ahead = pace
    for i in range(1, half + 1):
        # Midpoint rule, and after it two steps of Adams and Bashforth: one look at the field a step.
        if i == 1:
            ahead = sign * _pace(_at(both, place + 0.5 * pace), fast)
        else:
            before, pace = pace, sign * _pace(_at(both, place), fast)
            ahead = 1.5 * pace - 0.5 * before
        place = place + ahead
        track[half + i], track[half - i] = place[:, : len(chosen)], place[:, len(chosen) :]
    places = np.ascontiguousarray(grids.places[chosen].transpose(2, 1, 0))  # (3, 9, k)
    points = _at(places[:, :, None, :], track.transpose(1, 0, 2))  # (3, POINTS, k)
    points = np.ascontiguousarray(points.transpose(2, 1, 0))
    return Strokes(points, np.where(at_seed > NO_FIELD * fast, np.minimum(1.0, at_seed / fast), 0.0))


def fast_speed(values: np.ndarray) -> np.float32:
    """The speed that counts as fast: the 95th percentile of some vertices, never zero."""
    if not len(values):
        return np.float32(1.0)
    some = values[:: max(1, len(values) // SAMPLE)]
    return np.float32(max(float(np.percentile(np.linalg.norm(some, axis=1), 95)), 1e-12))


def _pace(vectors: np.ndarray, fast: np.float32) -> np.ndarray:
    """Directions (2, k), as long as the stroke's pace: a quarter in calm, 1 in fast flow, 0 at a fixed point."""
    speed = np.hypot(vectors[0], vectors[1])
    relative = np.minimum(np.float32(1.0), speed / fast)
    return vectors * ((np.float32(0.25) + np.float32(0.75) * relative) / np.maximum(speed, np.float32(0.02) * fast))


def _at(nodes: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Biquadratic interpolation. nodes: (c, 9, …, k); place: (2, …, k) in reaches, kept inside the grid."""
    x, y = np.clip(place, -1.0, 1.0)
    across = [(0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)) for t in (x, y)]
    total = np.zeros((nodes.shape[0], *x.shape), np.float32)
    for j, weight in enumerate(across[1]):
        row = sum(part * nodes[:, 3 * j + i] for i, part in enumerate(across[0]))
        total += weight * row
    return total


def _tangents(normals: np.ndarray) -> np.ndarray:
    """(k, 2, 3) two unit tangents, the same for the same normal."""
    helper = np.where(np.abs(normals[:, 2:]) < 0.8, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    first = np.cross(helper, normals)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-30)
    return np.stack([first, np.cross(normals, first)], axis=1)
