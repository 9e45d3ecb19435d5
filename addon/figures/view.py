# SPDX-License-Identifier: GPL-3.0-or-later
"""From which sides a surface is seen, and what is hidden there: projections, a depth buffer, shading. NumPy only.

    for view in choose_views(mesh):
        sight = look(mesh, view, width=900)
        xy = sight.project(points)                 # pixels
        visible = sight.sees(points, normals)
        image = shade(sight, colours)              # (h, w, 3)

A unit sphere that is exact to round-off, as winds are put onto, is seen as a longitude-latitude map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import native

#: Pixels that are tested at once.
CHUNK = 4_000_000


@dataclass(frozen=True, eq=False)
class View:
    """A parallel projection: unit vectors to the right, up and to the viewer. A map has none of them."""

    title: str
    axes: np.ndarray | None  #: (3, 3) rows right, up, towards

    @property
    def is_map(self) -> bool:
        return self.axes is None


def choose_views(mesh: native.TriangleMesh) -> tuple[View, ...]:
    """A map for winds, one view on an open surface from the side it faces, two opposite ones on any other."""
    vertices = mesh.vertices
    if mesh.euler_characteristic == 2 and np.abs(np.linalg.norm(vertices, axis=1) - 1.0).max() < 1e-12:
        return (View("", None),)
    facing = (mesh.face_areas[:, None] * mesh.face_normals).sum(axis=0)
    if np.linalg.norm(facing) > 0.7 * mesh.total_area:  # a sheet: seen as it lies
        return (View("", _axes(facing)),)
    towards = _broad_side(vertices)
    return (View("front", _axes(towards)), View("back", _axes(-towards)))


def _broad_side(vertices: np.ndarray) -> np.ndarray:
    """Across the shortest principal axis, from a little above and aside, so that depth shows."""
    spread, directions = np.linalg.eigh(np.cov((vertices - vertices.mean(axis=0)).T))
    if spread[0] > 0.6 * spread[2]:
        return np.array([0.45, -1.0, 0.45])
    across = directions[:, 0] * (1.0 if directions[:, 0] @ (0.3, -1.0, 0.6) > 0 else -1.0)
    return across + 0.35 * directions[:, 1] + 0.25 * directions[:, 2]


def _axes(towards: np.ndarray) -> np.ndarray:
    """Up is z, unless it is looked at from above or below: then y."""
    towards = towards / np.linalg.norm(towards)
    up = np.array([0.0, 0.0, 1.0]) if abs(towards[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


@dataclass(frozen=True, eq=False)
class Sight:
    """What is seen of a surface: per pixel (row 0 at the bottom) the face, its barycentric coordinates, the depth."""

    mesh: native.TriangleMesh
    view: View
    shape: tuple[int, int]  #: rows, columns
    scale: float  #: pixels per mesh unit (per degree on a map)
    origin: np.ndarray  #: (2,) lower left corner in the projection
    faces: np.ndarray  #: (h, w) int32, -1 where nothing is
    barycentric: np.ndarray  #: (h, w, 3)
    depth: np.ndarray  #: (h, w) towards the viewer, -inf where nothing is
    closed: bool

    def project(self, points: np.ndarray) -> np.ndarray:
        """(k, 3) → (k, 2) pixels."""
        return (_flat(self.view, points)[:, :2] - self.origin) * self.scale

    def sees(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """(k,) bool of points on the surface with its normals there."""
        if self.view.is_map:
            return np.ones(len(points), bool)
        assert self.view.axes is not None
        facing = normals @ self.view.axes[2]
        rows, columns = self.shape
        pixel = self.project(points)
        i = np.clip(pixel[:, 1].astype(np.int64), 0, rows - 1)
        j = np.clip(pixel[:, 0].astype(np.int64), 0, columns - 1)
        # On a slope the depth changes within the pixel.
        slope = np.sqrt(np.maximum(0.0, 1.0 - facing**2)) / np.maximum(np.abs(facing), 0.05)
        allowed = (1.0 + 1.5 * slope) / self.scale
        seen = points @ self.view.axes[2] >= self.depth[i, j] - allowed
        return seen & (facing > -0.02) if self.closed else seen


def look(mesh: native.TriangleMesh, view: View, width: int, margin: float = 0.02) -> Sight:
    """Draws faces and depth of the surface, `width` pixels wide (less where it is tall)."""
    flat = _flat(view, mesh.vertices)
    if view.is_map:
        low, high = np.array([-180.0, -90.0]), np.array([180.0, 90.0])
    else:
        used = flat[np.unique(mesh.triangles)]
        low, high = used[:, :2].min(axis=0), used[:, :2].max(axis=0)
        low, high = low - margin * (high - low).max(), high + margin * (high - low).max()
    size = high - low
    scale = width / max(size[0], size[1])
    shape = (max(1, int(np.ceil(size[1] * scale))), max(1, int(np.ceil(size[0] * scale))))
    closed = mesh.boundary_loop_count == 0
    if view.is_map:
        faces, barycentric = _map_faces(mesh, shape)
        depth = np.zeros(shape)
    else:
        pixels = np.column_stack([(flat[:, :2] - low) * scale, flat[:, 2]])
        faces, depth = _depth_buffer(pixels, mesh.triangles, shape)
        barycentric = _barycentric(pixels, mesh.triangles, faces)
    return Sight(mesh, view, shape, scale, low, faces, barycentric, depth, closed)


def shade(sight: Sight, colours: np.ndarray) -> np.ndarray:
    """(m, 3) colours per face → (h, w, 4) picture of the surface, lit from over the viewer's left shoulder."""
    picture = np.zeros((*sight.shape, 4))
    seen = sight.faces >= 0
    faces = sight.faces[seen]
    picture[seen, :3] = colours[faces]
    picture[seen, 3] = 1.0
    if sight.view.axes is not None:
        corners = sight.mesh.triangles[faces]
        normals = (sight.mesh.normals[corners] * sight.barycentric[seen][:, :, None]).sum(axis=1)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        light = np.array([-0.25, 0.3, 0.9]) @ sight.view.axes
        brightness = np.abs(normals @ (light / np.linalg.norm(light)))
        picture[seen, :3] *= (0.5 + 0.5 * np.minimum(1.0, 1.12 * brightness))[:, None]
    return picture


def _flat(view: View, points: np.ndarray) -> np.ndarray:
    """Projected points with their depth; degrees of longitude and latitude on a map."""
    if view.axes is not None:
        return points @ view.axes.T
    unit = points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-300)
    longitude, latitude = np.arctan2(unit[:, 1], unit[:, 0]), np.arcsin(np.clip(unit[:, 2], -1.0, 1.0))
    return np.column_stack([np.degrees(longitude), np.degrees(latitude), np.zeros(len(points))])


def _map_faces(mesh: native.TriangleMesh, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    latitude = np.radians((np.arange(shape[0]) + 0.5) / shape[0] * 180.0 - 90.0)[:, None]
    longitude = np.radians((np.arange(shape[1]) + 0.5) / shape[1] * 360.0 - 180.0)[None, :]
    place = np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude) + 0 * longitude
    faces, barycentric, _ = mesh.closest_points(np.stack(place, axis=-1).reshape(-1, 3))
    return faces.reshape(shape), barycentric.reshape(*shape, 3)


def _depth_buffer(pixels: np.ndarray, triangles: np.ndarray, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """The nearest face and its depth at the middle of every pixel. pixels: (n, 3) x, y and depth of the vertices."""
    faces = np.full(shape[0] * shape[1], -1, np.int32)
    depth = np.full(shape[0] * shape[1], -np.inf)
    corners = pixels[triangles]
    limit = np.array([shape[1], shape[0]])
    low = np.clip(np.ceil(corners[:, :, :2].min(axis=1) - 0.5), 0, limit).astype(np.int64)
    high = np.clip(np.floor(corners[:, :, :2].max(axis=1) - 0.5) + 1, 0, limit).astype(np.int64)
    extent = np.maximum(high - low, 0)
    count = extent.prod(axis=1)
    begin = 0
    ends = np.cumsum(count)
    while begin < len(count):
        done = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, done + CHUNK, side="right")))
        _draw(np.arange(begin, end), corners, low, extent, count, shape[1], faces, depth)
        begin = end
    return faces.reshape(shape), depth.reshape(shape)


def _draw(chosen, corners, low, extent, count, columns, faces, depth) -> None:
    face = np.repeat(chosen, count[chosen])
    first = np.repeat(np.cumsum(count[chosen]) - count[chosen], count[chosen])
    place = np.arange(len(face)) - first
    wide = extent[face, 0]
    x, y = low[face, 0] + place % wide, low[face, 1] + place // wide
    b = _coordinates(corners[face], x + 0.5, y + 0.5)
    inside = (b >= -1e-9).all(axis=1)
    face, pixel = face[inside], (y * columns + x)[inside]
    z = (b[inside] * corners[face][:, :, 2]).sum(axis=1)
    nearer = z > depth[pixel]
    face, pixel, z = face[nearer], pixel[nearer], z[nearer]
    order = np.argsort(z, kind="stable")  # the nearest is written last
    faces[pixel[order]] = face[order]
    depth[pixel[order]] = z[order]


def _coordinates(corners: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Barycentric coordinates in the picture; of a triangle seen edge-on, coordinates outside."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    safe = np.where(area == 0.0, 1.0, area)
    v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / safe
    w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / safe
    v = np.where(area == 0.0, -1.0, v)
    return np.stack([1.0 - v - w, v, w], axis=1)


def _barycentric(pixels: np.ndarray, triangles: np.ndarray, faces: np.ndarray) -> np.ndarray:
    result = np.zeros((*faces.shape, 3))
    y, x = np.nonzero(faces >= 0)
    result[y, x] = np.clip(_coordinates(pixels[triangles[faces[y, x]]], x + 0.5, y + 0.5), 0.0, 1.0)
    return result
