# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids without rows: UGRID meshes, cells with corners, and scattered places, which are triangulated."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass

import numpy as np

from ...model.errors import InputError
from .patch import welded
from .surface import Resolution, Surface, eastward, northward, on_sphere, once, outward, trimmed, upward

#: Triangles of scattered places with an edge longer than this many median edges are gaps.
LONG_EDGE = 5.0


@dataclass(frozen=True, eq=False)
class Nodes:
    """Values at the corners of polygons. places (n, 2): longitude and latitude in degrees, or x and y in a plane.
    polygons (m, k): corners from 0, −1 where there are fewer."""

    places: np.ndarray
    polygons: np.ndarray
    dims: tuple[str]
    spherical: bool = True
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int]:
        return (len(self.places),)

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        triangles, _ = _fans(self.polygons)
        triangles = triangles[valid[triangles].all(axis=1)]
        points = _points(self.places, self.spherical)
        triangles, _ = (outward if self.spherical else upward)(points, triangles)
        mesh, old, split = trimmed(points, once(triangles))
        east, north = _axes(self.places[old], self.spherical)

        def vectors(u: np.ndarray, v: np.ndarray) -> np.ndarray:
            return np.asarray(u, np.float64)[old, None] * east + np.asarray(v, np.float64)[old, None] * north

        changes = {
            "grid points without value, where the surface ends": int((~valid).sum()),
            "corners of coasts split": split,
        }
        return Surface(mesh, vectors, self.spherical, changes, self.notes)


@dataclass(frozen=True, eq=False)
class Cells:
    """Values in the middle of polygons, averaged to their corners by area. centres (m, 2) and corners (n, 2): longitude
    and latitude in degrees, or x and y."""

    centres: np.ndarray
    corners: np.ndarray
    polygons: np.ndarray
    dims: tuple[str]
    spherical: bool = True
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int]:
        return (len(self.polygons),)

    def surface(self, valid: np.ndarray, sample: tuple[np.ndarray, np.ndarray], size: Resolution) -> Surface:
        triangles, cell = _fans(self.polygons)
        cell, triangles = cell[valid[cell]], triangles[valid[cell]]
        points = _points(self.corners, self.spherical)
        triangles, kept = (outward if self.spherical else upward)(points, triangles)
        cell = cell[kept]
        mesh, _, split = trimmed(points, triangles)
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        weight = np.bincount(mesh.triangles.ravel(), np.repeat(area, 3), len(mesh.vertices))
        east, north = _axes(self.centres, self.spherical)
        normals = mesh.vertices if self.spherical else np.broadcast_to([0.0, 0.0, 1.0], mesh.vertices.shape)

        def vectors(u: np.ndarray, v: np.ndarray) -> np.ndarray:
            at_cells = (np.asarray(u, np.float64)[:, None] * east + np.asarray(v, np.float64)[:, None] * north)[cell]
            at_cells = np.repeat(at_cells * area[:, None], 3, axis=0)
            sums = [np.bincount(mesh.triangles.ravel(), at_cells[:, k], len(mesh.vertices)) for k in range(3)]
            means = np.column_stack(sums) / weight[:, None]
            return means - np.einsum("ij,ij->i", means, normals)[:, None] * normals

        changes = {
            "cells averaged to their corners": int(valid.sum()),
            "cells without value, where the surface ends": int((~valid).sum()),
            "corners of coasts split": split,
        }
        return Surface(mesh, vectors, self.spherical, changes, self.notes)


def cells_with_bounds(centres: np.ndarray, bounds: np.ndarray, dims: tuple[str]) -> Cells:
    """bounds (m, k, 2): longitude and latitude of the corners of each cell."""
    places = bounds.reshape(-1, 2)
    same = welded(_points(places, True), np.isfinite(places).all(axis=1))
    used, polygons = np.unique(same, return_inverse=True)
    polygons = polygons.reshape(bounds.shape[:2])
    # Cells of fewer corners repeat one of them.
    repeated = polygons == np.roll(polygons, 1, axis=1)
    order = np.argsort(repeated, axis=1, kind="stable")
    polygons = np.where(np.take_along_axis(repeated, order, axis=1), -1, np.take_along_axis(polygons, order, axis=1))
    return Cells(centres, places[used], polygons, dims)


def scattered(places: np.ndarray, dims: tuple[str], where: str) -> Nodes:
    """The Delaunay triangulation of longitudes and latitudes (n, 2) on the sphere: the convex hull of its points."""
    if importlib.util.find_spec("scipy") is None:
        raise InputError(
            f"{where}: joining places without a mesh to triangles needs the Python package scipy; "
            "install it with: pip install 'stormfield[grids]'"
        )
    from scipy.spatial import ConvexHull, QhullError

    points = _points(places, True)
    try:
        triangles = ConvexHull(points, qhull_options="Qt").simplices
    except (QhullError, ValueError) as error:
        raise InputError(f"{where}: {len(places)} places make no surface; give a grid or a mesh") from error
    longest = np.max(
        [np.linalg.norm(points[triangles[:, k]] - points[triangles[:, k - 1]], axis=1) for k in range(3)], axis=0
    )
    short = longest <= LONG_EDGE * np.median(longest)
    note = f"{len(places)} places without a mesh joined to {int(short.sum())} Delaunay triangles"
    if not short.all():
        note += f", {int((~short).sum())} left out that are more than {LONG_EDGE:g} times longer than usual"
    return Nodes(places, triangles[short], dims, True, (note,))


def _points(places: np.ndarray, spherical: bool) -> np.ndarray:
    if spherical:
        return on_sphere(places[:, 1], places[:, 0])
    return np.column_stack([places, np.zeros(len(places))])


def _axes(places: np.ndarray, spherical: bool) -> tuple[np.ndarray, np.ndarray]:
    if spherical:
        return eastward(places[:, 0]), northward(places[:, 1], places[:, 0])
    shape = (len(places), 3)
    return np.broadcast_to([1.0, 0.0, 0.0], shape), np.broadcast_to([0.0, 1.0, 0.0], shape)


def _fans(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each polygon as triangles around its first corner, and the polygon of each."""
    pairs = range(1, polygons.shape[1] - 1)
    triangles = np.concatenate([polygons[:, [0, k, k + 1]] for k in pairs])
    cell = np.tile(np.arange(len(polygons)), len(pairs))
    whole = (triangles >= 0).all(axis=1)
    return triangles[whole], cell[whole]
