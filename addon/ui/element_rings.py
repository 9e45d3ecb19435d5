# SPDX-License-Identifier: GPL-3.0-or-later
"""The ring of an element's radius with the sign of its flow, laid onto the surface around every place of its path.

On coarse meshes they are laid anew for each place. That would take too long where a ring crosses many faces: there they
are laid at some places along the path, when they are first asked for, and blended between two of them.
"""

from collections.abc import Callable

import numpy as np

from . import element_shapes as shapes
from . import geodesics
from .surface import LIFT, Surface, laid, lift

#: Distance of the places, over the radius.
APART = 0.25
#: Points of the ring, distance of the sign's over the radius, and how often all are moved towards their neighbours.
CORNERS, STEP, SMOOTHINGS = 96, 0.06, 6
#: Over LIFT: so high that rings blended over a ridge do not sink in.
HEIGHT = 2.0
#: Edges over the radius up to which a mesh counts as fine.
FINE = 0.1

Raise = Callable[[list[np.ndarray], Surface, object], list[np.ndarray]]


def exactly(lines: list[np.ndarray], surface: Surface, mesh) -> list[np.ndarray]:
    """Lines on the surface lifted off it, with more points where they would sink in."""
    return [laid(line, surface, mesh)[0] for line in lines]


def evenly(lines: list[np.ndarray], surface: Surface, mesh) -> list[np.ndarray]:
    """Lines lifted off the surface with the points that they have, so that they can be blended."""
    raised, normals = lift(np.concatenate(lines), surface, mesh)
    raised += (HEIGHT - 1.0) * LIFT * surface.size * normals
    return np.split(raised, np.cumsum([len(line) for line in lines])[:-1])


class Rings:
    def __init__(self, path: np.ndarray, normal: np.ndarray, radius: float, sign: list[np.ndarray], on) -> None:
        """path: (k, 3) on the surface or lifted off it; normal: (3,) at its first point, which gives a single place its
        axes. sign: polylines (k, 2) in radii. on: Surface and native mesh, None where it is no surface."""
        self.path, self.normal, self.radius = path, normal, radius
        self.surface, self.mesh = on
        self.flat = [shapes.resampled(line, STEP) for line in [*shapes.ring(), *sign]]
        self.arc = shapes.arc_length(path)
        self._laid: dict[int, list[np.ndarray]] = {}

    def at(self, arc: float) -> list[np.ndarray]:
        """Polylines (k, 3) around the place at that length of the path, lifted off the surface."""
        arc = min(max(arc, 0.0), self.arc[-1])
        if self.mesh is None or self.mesh.mean_edge_length > FINE * self.radius:
            return self._lay(arc, exactly)
        number, share = divmod(arc / (APART * self.radius), 1.0)
        before = self._around(int(number))
        if share < 1e-6:
            return before
        after = self._around(int(number) + 1)
        return [a + share * (b - a) for a, b in zip(before, after, strict=True)]

    def _around(self, number: int) -> list[np.ndarray]:
        if number not in self._laid:
            self._laid[number] = self._lay(min(number * APART * self.radius, self.arc[-1]), evenly)
        return self._laid[number]

    def _lay(self, arc: float, raised: Raise) -> list[np.ndarray]:
        centre = self._place(arc)
        if self.mesh is None:
            return [centre + self.radius * line @ self._axes(arc, self.normal) for line in self.flat]
        faces, barycentric, _ = self.mesh.closest_points(centre[None])
        (start,) = np.asarray(self.mesh.positions(faces, barycentric))
        axes = self._axes(arc, self.surface.area_vectors[faces[0]])
        flat = np.concatenate(self.flat)
        lengths = self.radius * np.linalg.norm(flat, axis=1)
        count = len(flat)
        reached = geodesics.walk(
            self.surface, np.repeat(faces, count), np.tile(start, (count, 1)), flat @ axes, lengths
        )
        lines = np.split(reached, np.cumsum([len(line) for line in self.flat])[:-1])
        lines = [shapes.smoothed(line, SMOOTHINGS) for line in lines]  # ways part behind a peak and cross in a hollow
        lines[0] = shapes.spread(lines[0], CORNERS)
        return raised(lines, self.surface, self.mesh)

    def _place(self, arc: float) -> np.ndarray:
        return np.array([np.interp(arc, self.arc, self.path[:, axis]) for axis in range(3)])

    def _axes(self, arc: float, normal: np.ndarray) -> np.ndarray:
        """(2, 3) in the plane of a normal: the first ahead along the path."""
        normal = normal / max(float(np.linalg.norm(normal)), 1e-300)
        reach = 0.5 * self.radius
        ahead = self._place(min(arc + reach, self.arc[-1])) - self._place(max(arc - reach, 0.0))
        first = ahead - normal * (ahead @ normal)
        if np.linalg.norm(first) < 1e-12:
            first = np.cross(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.8 else (0.0, 1.0, 0.0))
        first = first / np.linalg.norm(first)
        return np.stack([first, np.cross(normal, first)])
