# SPDX-License-Identifier: GPL-3.0-or-later
"""The strokes that one view of one object shows: evenly spaced on screen, and steady while λ or the view changes.

    strokes = ViewStrokes(surface, mesh, seeds)         # one for each object and view
    batch = strokes.batch(view, values, version, spacing=16.0, length=2.4)

Work is done again only for what has changed: for another view the seeds that come into it, for another field (another
`version`) the strokes.
"""

from dataclasses import dataclass

import numpy as np

from .stroke_seeds import SeedLevels
from .stroke_shader import StrokeBatch
from .strokes import Grids, strokes
from .surface import Surface

#: Strokes are drawn a little beyond the view's edges, and of closed surfaces a little beyond the horizon.
MARGIN, HORIZON = 1.15, -0.1
#: Seeds join at this part of the distance between strokes; the shader lets them grow from nothing.
JOINS = 0.95
#: Most strokes of one view.
MOST = 8000


@dataclass(frozen=True)
class View:
    """How an object is seen."""

    projection: np.ndarray  #: (4, 4) object to clip space
    size: tuple[float, float]  #: of the region, pixels
    scale: float  #: pixels of one mesh unit where clip space has w = 1
    eye: np.ndarray  #: (4,) in object space: a place (w = 1), or the direction towards the viewer (w = 0)

    def pixels_per_unit(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(k,) at each place, 0 where it is not in view; and (k,) whether it is in view."""
        clip = positions @ self.projection[:, :3].T + self.projection[:, 3]
        depth = clip[:, 3]
        inside = (depth > 1e-9) & (np.abs(clip[:, :2]) <= MARGIN * depth[:, None]).all(axis=1)
        inside &= clip[:, 2] >= -depth  # what is nearer than the clipping plane has no end of detail
        return np.where(inside, self.scale / np.maximum(depth, 1e-9), 0.0), inside

    def facing(self, positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """(k,) cosine between the normal and the direction to the viewer."""
        towards = self.eye[:3] - self.eye[3] * positions
        towards = towards / np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-30)
        return (towards * normals).sum(axis=1)


class ViewStrokes:
    """Grids, choice of seeds and the strokes on the GPU of one object in one view."""

    def __init__(self, surface: Surface, mesh, seeds: SeedLevels) -> None:
        self.surface, self.seeds = surface, seeds
        self.grids = Grids(surface, mesh, seeds)
        self.closed = mesh is not None and mesh.boundary_loop_count == 0
        self.chosen = np.zeros(0, np.int64)
        self._view_key: tuple = ()
        self._key: tuple = ()
        self._batch: StrokeBatch | None = None

    def batch(self, view: View, values: np.ndarray, version: object, spacing: float, length: float) -> StrokeBatch:
        """values: (n, 3) float32 at the vertices. spacing: pixels between strokes; length: over spacing."""
        view_key = (view.projection.tobytes(), view.size, view.scale, spacing, length)
        if self._view_key != view_key:
            self._choose(view, spacing, length)
            self._view_key = view_key
        key = (version, self.chosen.tobytes(), self.grids.reach[self.chosen].tobytes())
        if self._batch is None or self._key != key:
            drawn = strokes(self.grids, self.chosen, values)
            self._batch = StrokeBatch(drawn, self.seeds.spacing[self.chosen], self.grids.reach[self.chosen])
            self._key = key
        return self._batch

    def _choose(self, view: View, spacing: float, length: float) -> None:
        """Seeds that the view has room for, and grids around them as large as their strokes."""
        self.seeds.refine(np.inf)
        for _ in range(2):  # the coarse levels tell how near the surface is
            pixels, inside = view.pixels_per_unit(self.seeds.positions)
            if inside.any():
                self.seeds.refine(JOINS * spacing / float(pixels.max()))
        pixels, inside = view.pixels_per_unit(self.seeds.positions)
        near = np.flatnonzero(inside)
        if self.closed:
            near = near[view.facing(self.seeds.positions[near], self.seeds.normals[near]) > HORIZON]
        self.seeds.refine_near(near, JOINS * spacing / pixels[near])
        pixels, inside = view.pixels_per_unit(self.seeds.positions)
        shown = inside & (self.seeds.spacing * pixels >= JOINS * spacing)
        chosen = np.flatnonzero(shown)
        if self.closed:
            facing = view.facing(self.seeds.positions[chosen], self.seeds.normals[chosen])
            chosen = chosen[facing > HORIZON]
        self.chosen = chosen[:MOST]  # the coarsest first
        self.grids.prepare(self.chosen, 0.5 * length * _steps(spacing / pixels[self.chosen], self.chosen))


def _steps(distance: np.ndarray, number: np.ndarray) -> np.ndarray:
    """The next step of √2 at or above each distance; steps differ from seed to seed, so that in a zoom few change at a
    time."""
    shift = (number * 0.6180339887498949) % 1.0
    return 2.0 ** ((np.ceil(2.0 * np.log2(distance) + shift) - shift) / 2.0)
