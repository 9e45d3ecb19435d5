# SPDX-License-Identifier: GPL-3.0-or-later
"""Where strokes begin: places spread evenly over a surface, in levels, so that coarse ones stay when finer ones join.

    seeds = SeedLevels(surface)
    seeds.refine(0.02)                  # so that a view may draw strokes 0.02 mesh units apart
    seeds.spacing[i]                    # the distance at which place i joins: a view draws those it has room for

The places follow from the surface alone: they stay while λ, the view and the density change.
"""

import numpy as np

from .surface import Surface

#: Distance of the coarsest level over the object's longest side, and of each level over that of the level before.
COARSEST, FINER = 0.25, 2.0**-0.5
#: Edge of a cell that holds one place, over the level's distance; grids of such cells, turned against each other, so
#: that close places are seldom parted by all of them; and how often holes are filled.
CELL, GRIDS, ROUNDS = 0.9, 5, 3
#: Candidates for each square of a level's distance, at most; and slots of the table of cells for each candidate.
TRIED, MOST, SLOTS = 8.0, 400_000, 8


class SeedLevels:
    """k places, the coarsest level first; finer levels are appended."""

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.faces = np.zeros(0, np.int32)  #: (k,)
        self.barycentric = np.zeros((0, 3))  #: (k, 3) float64
        self.positions = np.zeros((0, 3))  #: (k, 3) float64, on the surface
        self.normals = np.zeros((0, 3))  #: (k, 3) float64, unit
        self.spacing = np.zeros(0)  #: (k,) mesh units, decreasing
        self._candidates = np.zeros(0, np.int64)  #: (k,) which candidates they were
        extent = np.ptp(surface.vertices, axis=0).max() if len(surface.vertices) else 0.0
        areas = 0.5 * np.linalg.norm(surface.area_vectors, axis=1)
        self._area = float(areas.sum())
        self._shares = np.cumsum(areas) / self._area if self._area > 0 else areas
        self._next = COARSEST * float(extent)

    def __len__(self) -> int:
        return len(self.faces)

    def refine(self, finest: float) -> None:
        """Add the levels down to the first whose distance is at most `finest` (mesh units)."""
        while self._area > 0 and self._next > 0 and (not len(self) or self.spacing[-1] > finest):
            tried = int(TRIED * self._area / self._next**2) + 64
            if tried > MOST:
                return
            self._add_level(tried)
            self._next *= FINER

    def _add_level(self, tried: int) -> None:
        count = max(tried, int(self._candidates.max(initial=-1)) + 1)
        faces, barycentric, positions = self._places(np.arange(count))
        fresh = _fill(positions, tried, self._candidates, self._next)
        vertices = self.surface.triangles[faces[fresh]]
        normals = np.einsum("kc,kcd->kd", barycentric[fresh], self.surface.normals[vertices])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        self._candidates = np.concatenate([self._candidates, fresh])
        self.faces = np.concatenate([self.faces, faces[fresh]])
        self.barycentric = np.concatenate([self.barycentric, barycentric[fresh]])
        self.positions = np.concatenate([self.positions, positions[fresh]])
        self.normals = np.concatenate([self.normals, normals])
        self.spacing = np.concatenate([self.spacing, np.full(len(fresh), self._next)])

    def _places(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Faces, barycentric coordinates and positions of a low-discrepancy sequence by area."""
        steps = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
        along, u, v = ((0.5 + index * step) % 1.0 for step in steps)
        faces = np.searchsorted(self._shares, along).clip(max=len(self._shares) - 1).astype(np.int32)
        root = np.sqrt(u)
        barycentric = np.stack([1 - root, root * (1 - v), root * v], axis=1)
        corners = self.surface.vertices[self.surface.triangles[faces]]
        return faces, barycentric, np.einsum("kc,kcd->kd", barycentric, corners)


def _fill(positions: np.ndarray, tried: int, chosen: np.ndarray, distance: float) -> np.ndarray:
    """Of the first candidates those whose cells hold no chosen place and no other of them, in none of the grids."""
    grids = [_cells(positions @ turn.T, CELL * distance) for turn in _turns()]
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


def _cells(positions: np.ndarray, cell: float) -> tuple[np.ndarray, int]:
    """(k,) int64: a slot for each cell of a grid, and how many slots there are. Two cells in one slot do no harm."""
    slots = 1 << int(SLOTS * max(len(positions), 64) - 1).bit_length()
    x, y, z = np.floor(positions / cell).astype(np.int64).T
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791) & (slots - 1), slots
