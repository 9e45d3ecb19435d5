# SPDX-License-Identifier: GPL-3.0-or-later
"""A latitude-longitude grid that goes around the globe → a sphere of nearly equal triangles.

The vectors are turned into space first and interpolated there, bilinearly in latitude and longitude, so that the poles
need no special case: a pole's vector is the mean around it. Where values are missing the surface ends.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...model.errors import InputError
from ..icosphere import MAX_FACES, icosphere
from .surface import Resolution, Surface, eastward, northward, trimmed

#: Faces of a sphere whose resolution follows the data, at most.
MAX_AUTO_FACES = 4_000_000
#: Rows of a grid, and points, that are computed with at a time.
ROWS, POINTS = 64, 1 << 15
#: How far the vectors of a pole row may be from one vector, and that from the row beside it, of the length of vectors.
POLE_SPREAD, POLE_STEP = 0.2, 0.5


@dataclass(frozen=True, eq=False)
class Globe:
    """latitude (a,) and longitude (b,) in degrees, in any order, once around; dims and arrays as (a, b)."""

    latitude: np.ndarray
    longitude: np.ndarray
    dims: tuple[str, str]
    where: str

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.latitude), len(self.longitude)

    @property
    def spacing(self) -> float:
        """Degrees between neighbours at the equator."""
        return float(min(np.median(np.abs(np.diff(self.latitude))), 360.0 / len(np.unique(_turned(self.longitude)))))

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        faces = auto_faces(self.spacing) if size.faces is None else size.faces
        notes = []
        rows, columns = self._order(valid)
        latitude, longitude = np.clip(self.latitude[rows], -90.0, 90.0), _turned(self.longitude)[columns]
        valid = valid[rows][:, columns]
        u, v = (values[rows][:, columns] for values in sample)
        kept = np.ones(len(latitude), bool)
        for end, name in ((0, "south"), (-1, "north")):
            if abs(abs(latitude[end]) - 90.0) < 1e-6 and not _one_vector(longitude, u, v, valid, end):
                kept[end] = False
                if valid[end].any():
                    notes.append(f"the row of the {name} pole is not one vector, so that the next row is used")
        rows, latitude, valid = rows[kept], latitude[kept], valid[kept]
        step = float(np.median(np.diff(latitude)))
        poles = (
            90.0 + latitude[0] <= 1.5 * step + 1e-6 and bool(valid[0].all()),
            90.0 - latitude[-1] <= 1.5 * step + 1e-6 and bool(valid[-1].all()),
        )
        sampler = _Sampler(rows, columns, latitude, longitude, poles)
        sphere = icosphere(faces)
        stencil = sampler.stencil(sphere.vertices)
        inside = stencil.inside(sampler.extended(valid))
        whole = inside[sphere.triangles].all(axis=1)
        if whole.all():
            mesh, changes = sphere, {}
        else:
            mesh, _, _ = trimmed(sphere.vertices, sphere.triangles[whole])
            stencil = sampler.stencil(mesh.vertices)
            changes = {"grid points without value, where the surface ends": int((~valid).sum())}
            if not any(poles) and bool(valid.all()):
                changes = {}
            notes += [
                f"the surface ends at {latitude[end]:g}° latitude, where the grid does"
                for end in (0, -1)
                if not poles[end] and valid[end].any()
            ]
        edge = edge_of(len(sphere.triangles))
        notes.append(f"sphere of {len(sphere.triangles)} faces, {edge:.2g}° an edge, for a grid of {self.spacing:.3g}°")
        if edge > 1.5 * self.spacing:
            notes[-1] += ", which is finer: small storms may be lost; choose more with --sphere-faces"
        return Surface(mesh, lambda u, v: stencil.vectors(sampler, u, v), True, changes, tuple(notes))

    def _order(self, valid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows from south to north, columns once around from the smallest longitude in 0..360. Of columns at one
        longitude the one with most values."""
        rows = np.argsort(self.latitude, kind="stable")
        spacing = np.diff(self.latitude[rows])
        if spacing.min() <= 0.0:
            raise InputError(f"{self.where}: latitude {self.latitude[rows][int(np.argmin(spacing))]:g} is given twice")
        turned = _turned(self.longitude)
        ordered = np.lexsort((np.arange(len(turned)), -valid.sum(axis=0), turned))
        _, first = np.unique(turned[ordered], return_index=True)
        return rows, ordered[first]


def is_around(longitude: np.ndarray) -> bool:
    """Whether longitudes leave no gap."""
    turned = np.unique(_turned(longitude))
    steps = np.diff(np.append(turned, turned[0] + 360.0))
    return len(turned) >= 3 and bool(steps.max() <= 1.5 * np.median(steps) + 1e-6)


def auto_faces(spacing: float) -> int:
    """Faces of a sphere whose edges are as long as the spacing of a grid, in degrees."""
    area = np.sqrt(3.0) / 4.0 * np.radians(spacing) ** 2
    return int(np.clip(4.0 * np.pi / area, 1280, min(MAX_AUTO_FACES, MAX_FACES)))


def edge_of(faces: int) -> float:
    """Mean length of an edge of a sphere of so many faces, in degrees."""
    return float(np.degrees(np.sqrt(4.0 * np.pi / faces * 4.0 / np.sqrt(3.0))))


def _turned(longitude: np.ndarray) -> np.ndarray:
    # Rounding keeps 359.9999999 and -1e-7 the same meridian.
    return np.round(np.mod(longitude, 360.0), 6) % 360.0


def _one_vector(longitude, u, v, valid, end: int) -> bool:
    """Whether a pole row is what it has to be: the same vector in space at every longitude, like that of the row beside
    it. Files repeat components instead, which is another vector at each longitude, or write zeros."""
    if not valid[end].all():
        return False
    beside = 1 if end == 0 else -2
    row, next_row = (_horizontal(longitude, u[at], v[at], end) for at in (end, beside))
    next_row = next_row[valid[beside]]
    lengths = [float(np.sqrt((vectors**2).sum(axis=1).mean())) for vectors in (row, next_row) if len(vectors)]
    spread = float(np.sqrt(((row - row.mean(axis=0)) ** 2).sum(axis=1).mean()))
    step = float(np.linalg.norm(row.mean(axis=0) - next_row.mean(axis=0))) if valid[beside].all() else 0.0
    return spread <= POLE_SPREAD * max(lengths) and step <= POLE_STEP * max(lengths)


def _horizontal(longitude, u, v, end: int) -> np.ndarray:
    """Vectors at a pole in the plane of the equator."""
    theta = np.radians(longitude)
    outward = -1.0 if end == -1 else 1.0
    return np.stack(
        [-np.sin(theta) * u + outward * np.cos(theta) * v, np.cos(theta) * u + outward * np.sin(theta) * v], axis=1
    )


class _Sampler:
    """Arrays of the file → rows from pole to pole, with a row of the mean vector at a pole that is covered."""

    def __init__(self, rows, columns, latitude, longitude, poles: tuple[bool, bool]) -> None:
        self.rows, self.columns = rows, columns
        self.longitude = longitude
        self.own = latitude
        self.poles = poles
        at_pole = (latitude[0] <= -90.0 + 1e-6, latitude[-1] >= 90.0 - 1e-6)
        self.added = (poles[0] and not at_pole[0], poles[1] and not at_pole[1])
        self.latitude = np.concatenate([[-90.0] if self.added[0] else [], latitude, [90.0] if self.added[1] else []])
        self._east = eastward(longitude)[None]
        self._north = northward(latitude[:, None], longitude[None])

    def extended(self, valid: np.ndarray) -> np.ndarray:
        return np.pad(valid, [tuple(map(int, self.added)), (0, 0)], constant_values=True)

    def in_space(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """(rows · columns, 3), zero where there is no value."""
        whole = np.empty((len(self.latitude), len(self.longitude), 3))
        own = whole[int(self.added[0]) : len(whole) - int(self.added[1])]
        for part in _blocks(len(own), ROWS):
            of_file = np.ix_(self.rows[part], self.columns)
            np.multiply(u[of_file][..., None], self._east, out=own[part])
            own[part] += v[of_file][..., None] * self._north[part]
        for end in (0, -1):
            if self.poles[end]:
                whole[end] = own[end].mean(axis=0) * [1.0, 1.0, 0.0]
        return np.nan_to_num(whole.reshape(-1, 3), copy=False)

    def stencil(self, points: np.ndarray) -> _Stencil:
        """The four grid points around each point and their weights."""
        at_latitude = np.degrees(np.arcsin(np.clip(points[:, 2], -1.0, 1.0)))
        first = self.longitude[0]
        at_longitude = np.mod(np.degrees(np.arctan2(points[:, 1], points[:, 0])) - first, 360.0) + first
        closed = np.append(self.longitude, first + 360.0)
        row = np.clip(np.searchsorted(self.latitude, at_latitude, side="right") - 1, 0, len(self.latitude) - 2)
        column = np.clip(np.searchsorted(closed, at_longitude, side="right") - 1, 0, len(closed) - 2)
        up = (at_latitude - self.latitude[row]) / (self.latitude[row + 1] - self.latitude[row])
        along = (at_longitude - closed[column]) / (closed[column + 1] - closed[column])
        after, width = (column + 1) % len(self.longitude), len(self.longitude)
        places = np.stack(
            [row * width + column, row * width + after, (row + 1) * width + column, (row + 1) * width + after]
        )
        weights = np.stack([(1 - up) * (1 - along), (1 - up) * along, up * (1 - along), up * along])
        covered = (up > -1e-6) & (up < 1.0 + 1e-6)
        return _Stencil(points, places, weights, covered)


@dataclass(frozen=True, eq=False)
class _Stencil:
    """places, weights (4, n): grid points around each of the n points (n, 3)."""

    points: np.ndarray
    places: np.ndarray
    weights: np.ndarray
    covered: np.ndarray

    def inside(self, valid: np.ndarray) -> np.ndarray:
        """(n,) whether every grid point that counts has a value."""
        counts = np.abs(self.weights) > 1e-9
        return self.covered & (valid.ravel()[self.places] | ~counts).all(axis=0)

    def vectors(self, sampler: _Sampler, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        grid = sampler.in_space(u, v)
        result = np.zeros(self.points.shape)
        for part in _blocks(len(result), POINTS):
            mean, points = result[part], self.points[part]
            for place, weight in zip(self.places[:, part], self.weights[:, part], strict=True):
                mean += weight[:, None] * np.take(grid, place, axis=0, mode="clip")
            mean -= np.einsum("ij,ij->i", mean, points)[:, None] * points
        return result


def _blocks(count: int, size: int) -> Iterator[slice]:
    """Blocks whose arrays stay in the processor's cache, which is four times as fast as whole arrays."""
    return (slice(first, first + size) for first in range(0, count, size))
