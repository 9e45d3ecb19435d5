# SPDX-License-Identifier: GPL-3.0-or-later
"""Where strokes begin: places spread evenly over a surface, in levels, so that coarse ones stay when finer ones join.

    seeds = SeedLevels(surface)
    seeds.refine(0.02)                  # so that a view may draw strokes 0.02 mesh units apart
    seeds.spacing[i]                    # the distance at which place i joins: a view draws those it has room for

The places follow from the surface alone: they stay while λ, the view and the density change.
"""

from functools import cached_property

import numpy as np

from .surface import Surface

#: Distance of the coarsest level over the object's longest side, and of each level over that of the level before.
COARSEST, FINER = 0.25, 2.0**-0.5
#: Edge of a cell that holds one place, over the level's distance; grids of such cells, turned against each other, so
#: that close places are seldom parted by all of them; and how often holes are filled.
CELL, GRIDS, ROUNDS = 0.9, 5, 3
#: Candidates for each square of a level's distance, at most; and slots of the table of cells for each candidate.
TRIED, MOST, SLOTS = 8.0, 200_000, 8
#: Edge of the cubes in which finer levels are added, over their distance.
BLOCK = 24.0


class SeedLevels:
    """k places, the coarsest level first; finer ones are appended, of all of the surface, then where a view is near."""

    def __init__(self, surface: Surface, parts: np.ndarray | None = None) -> None:
        """parts: (m,) a number for each triangle; places keep no distance to those of other parts, which may lie close
        behind."""
        self.surface = surface
        self.parts = np.zeros(len(surface.triangles), np.int64) if parts is None else parts.astype(np.int64)
        self.faces = np.zeros(0, np.int32)  #: (k,)
        self.barycentric = np.zeros((0, 3))  #: (k, 3) float64
        self.positions = np.zeros((0, 3))  #: (k, 3) float64, on the surface
        self.normals = np.zeros((0, 3))  #: (k, 3) float64, unit
        self.spacing = np.zeros(0)  #: (k,) mesh units, decreasing while the whole surface is refined
        self._candidates = np.zeros(0, np.int64)  #: (k,) which candidates they were
        extent = np.ptp(surface.vertices, axis=0).max() if len(surface.vertices) else 0.0
        areas = 0.5 * np.linalg.norm(surface.area_vectors, axis=1)
        self._area = float(areas.sum())
        self._shares = np.cumsum(areas) / self._area if self._area > 0 else areas
        self._blocks: set[tuple] = set()  #: distance and cube of what was refined by itself
        self._next = COARSEST * float(extent)

    def __len__(self) -> int:
        return len(self.faces)

    def refine(self, finest: float) -> None:
        """Add the levels down to the first whose distance is at most `finest` (mesh units)."""
        while self._area > 0 and self._next > 0 and (not len(self) or self._next / FINER > finest):
            tried = int(TRIED * self._area / self._next**2) + 64
            if tried > MOST:
                return
            self._add_level(tried)
            self._next *= FINER

    def refine_near(self, near: np.ndarray, finest: np.ndarray) -> None:
        """Finer levels than all of a surface has room for, in blocks around some places only.

        near: (k,) numbers of places; finest: (k,) distance that is wanted around each, mesh units."""
        distance = self._next
        while len(near) and distance > 0 and (finest < distance / FINER).any():
            wanted = near[finest < distance / FINER]
            edge = max(BLOCK * distance, 2.0 * self._face_size)  # a triangle belongs to one cube
            for block in np.unique(np.floor(self.positions[wanted] / edge).astype(np.int64), axis=0):
                key = (distance, *block.tolist())
                if key not in self._blocks:
                    self._blocks.add(key)
                    self._add_block(distance, block * edge, edge)
            distance *= FINER

    def _add_block(self, distance: float, low: np.ndarray, edge: float) -> None:
        """One level in a cube. What lies around it keeps its distance too."""
        inside = np.flatnonzero(((self._middles >= low) & (self._middles < low + edge)).all(axis=1))
        shares = np.cumsum(np.linalg.norm(self.surface.area_vectors[inside], axis=1)) * 0.5
        if not len(shares) or shares[-1] <= 0:
            return
        tried = int(TRIED * shares[-1] / distance**2) + 8
        if tried > MOST:
            return
        index, barycentric = _sequence(np.arange(tried), shares / shares[-1])
        faces = inside[index].astype(np.int32)
        corners = self.surface.vertices[self.surface.triangles[faces]]
        positions = np.einsum("kc,kcd->kd", barycentric, corners)
        around = ((self.positions >= low - distance) & (self.positions < low + edge + distance)).all(axis=1)
        known = self.positions[around]
        parts = self.parts[np.concatenate([faces, self.faces[around]])]
        fresh = _fill(np.concatenate([positions, known]), parts, tried, tried + np.arange(len(known)), distance)
        self._append(faces, barycentric, positions, fresh, distance)

    @cached_property
    def _face_size(self) -> float:
        """Mesh units: side of a square as large as a mean triangle."""
        return float(np.sqrt(self._area / max(len(self.surface.triangles), 1)))

    @cached_property
    def _middles(self) -> np.ndarray:
        """(m, 3) of the triangles."""
        return self.surface.vertices[self.surface.triangles].mean(axis=1)

    def _add_level(self, tried: int) -> None:
        count = max(tried, int(self._candidates.max(initial=-1)) + 1)
        faces, barycentric, positions = self._places(np.arange(count))
        fresh = _fill(positions, self.parts[faces], tried, self._candidates, self._next)
        self._candidates = np.concatenate([self._candidates, fresh])
        self._append(faces, barycentric, positions, fresh, self._next)

    def _append(self, faces, barycentric, positions, fresh: np.ndarray, distance: float) -> None:
        vertices = self.surface.triangles[faces[fresh]]
        normals = np.einsum("kc,kcd->kd", barycentric[fresh], self.surface.normals[vertices])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        self.faces = np.concatenate([self.faces, faces[fresh]])
        self.barycentric = np.concatenate([self.barycentric, barycentric[fresh]])
        self.positions = np.concatenate([self.positions, positions[fresh]])
        self.normals = np.concatenate([self.normals, normals])
        self.spacing = np.concatenate([self.spacing, np.full(len(fresh), distance)])

    def _places(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Faces, barycentric coordinates and positions of a low-discrepancy sequence by area."""
        faces, barycentric = _sequence(index, self._shares)
        corners = self.surface.vertices[self.surface.triangles[faces]]
        return faces, barycentric, np.einsum("kc,kcd->kd", barycentric, corners)


def _sequence(index: np.ndarray, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces (k,) int32 and barycentric coordinates (k, 3). shares: (m,) of the area, added up."""
    steps = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
    along, u, v = ((0.5 + index * step) % 1.0 for step in steps)
    root = np.sqrt(u)
    faces = np.searchsorted(shares, along).clip(max=len(shares) - 1).astype(np.int32)
    return faces, np.stack([1 - root, root * (1 - v), root * v], axis=1)


def _fill(positions: np.ndarray, parts: np.ndarray, tried: int, chosen: np.ndarray, distance: float) -> np.ndarray:
    """Of the first candidates those whose cells hold no chosen place and no other of them, in none of the grids."""
    grids = [_cells(positions @ turn.T, parts, CELL * distance) for turn in _turns()]
    taken = chosen
    for _ in range(ROUNDS):
        kept = np.arange(tried)
        for keys, slots in grids:
            held = np.zeros(slots, bool)
            held[keys[taken]] = True
            kept = kept[~held[keys[kept]]]
        for keys, slots in grids:
            first = np.empty(slots, np.int64)
            first[keys[kept[::-1]]] = kept[::-1]  # the last that is written stays: the first of each cell
            kept = kept[first[keys[kept]] == kept]
        taken = np.concatenate([taken, kept])
    return taken[len(chosen) :]


def _turns() -> list[np.ndarray]:
    """Rotations of the grids, always the same."""
    matrices = np.random.default_rng(7).normal(size=(GRIDS, 3, 3))
    return [np.linalg.qr(matrix)[0] for matrix in matrices]


def _cells(positions: np.ndarray, parts: np.ndarray, cell: float) -> tuple[np.ndarray, int]:
    """(k,) int64: a slot for each cell of a grid and part, and how many slots there are. Sharing one does no harm."""
    slots = 1 << int(SLOTS * max(len(positions), 64) - 1).bit_length()
    x, y, z = np.floor(positions / cell).astype(np.int64).T
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791 ^ parts * 49979687) & (slots - 1), slots
