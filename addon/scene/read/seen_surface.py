# SPDX-License-Identifier: GPL-3.0-or-later
"""From the surface that is seen to the mesh at rest, on which fields live.

Artists draw on what they see: posed, subdivided, repeated. A point is carried by its barycentric place in the triangle
that is seen, and keeps its height above the surface. What lies nearer to the mesh at rest was made there, and stays.
"""

from dataclasses import dataclass
from typing import Any

import bmesh
import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

from .attached import NAMES, TURN, modifiers_of
from .mesh import loop_triangles
from .places import Places

#: Blender's attribute of the places of vertices before shape keys and modifiers.
REST = "rest_position"
#: Kinds of parents that bend what they carry.
BENDING_PARENTS = frozenset({"ARMATURE", "LATTICE", "CURVE"})


def is_changed(obj: bpy.types.Object) -> bool:
    """Whether shape keys, modifiers or a parent may change the surface that is seen."""
    own = [modifier for sort in (*NAMES, TURN) for modifier in modifiers_of(obj, sort)]
    return (
        obj.data.shape_keys is not None
        or any(modifier not in own for modifier in obj.modifiers)
        or (obj.parent is not None and obj.parent_type in BENDING_PARENTS)
    )


class SeenSurface:
    """The surface of an object as it is seen at the current frame of `places`, in the object's space."""

    def __init__(self, places: Places, obj: bpy.types.Object):
        self.places, self.obj = places, obj
        self._rest = _Surface(obj.data, _positions(obj.data)) if is_changed(obj) and obj.mode != "EDIT" else None
        self._seen: _Surface | None = None
        self._at_rest = np.zeros((0, 3))  #: of the vertices of `_seen`

    def is_mirrored_at(self, line: np.ndarray) -> bool:
        """Whether a line lies on a copy that a modifier mirrors, where left and right are exchanged."""
        spots = self._spots(line)
        if spots is None or self._rest is None:
            return False
        place, normal = spots[0].carried(self._at_rest), spots[0].normal(self._at_rest)
        own = self._rest.nearest(place)
        return bool(normal @ own.normal(self._rest.points) < 0.0)

    def line_at_rest(self, line: np.ndarray) -> np.ndarray:
        """(n, 3) points, carried together."""
        spots = self._spots(line)
        return line if spots is None else np.array([spot.carried(self._at_rest) for spot in spots])

    def arrow_at_rest(self, arrow: np.ndarray) -> np.ndarray:
        """(2, 3) a point and the tip of an arrow there, which turns with the surface."""
        spots = self._spots(arrow[:1])
        if spots is None:
            return arrow
        place = spots[0].carried(self._at_rest)
        return np.array([place, place + spots[0].turned(arrow[1] - arrow[0], self._at_rest)])

    def _spots(self, points: np.ndarray) -> "list[_Spot] | None":
        """Where points lie on the seen surface; None where they lie on the mesh at rest, or where that is seen."""
        if self._rest is None or not self._look():
            return None
        spots = [self._seen.nearest(point) for point in points]
        away = sum(spot.distance for spot in spots)
        return spots if away <= sum(self._rest.nearest(point).distance for point in points) else None

    def _look(self) -> bool:
        """Whether what is seen now differs from the mesh at rest."""
        mesh = self.places.of(self.obj).evaluated.data
        rest = _rest_positions(self.obj.data, mesh)
        if rest is None:
            mesh = self.places.with_rest_positions(self.obj)
            rest = _rest_positions(self.obj.data, mesh)
        if rest is None:  # made anew by a modifier, without relation to the mesh at rest
            return False
        points = _positions(mesh)
        if self._seen is None or not np.array_equal(self._seen.points, points):
            self._seen, self._at_rest = _Surface(mesh, points), rest
        return not (len(points) == len(self._rest.points) and np.allclose(points, self._rest.points, atol=1e-7))


@dataclass(frozen=True)
class _Spot:
    """The point of a surface that is nearest to another."""

    corners: np.ndarray  #: (3,) vertices of its triangle
    places: np.ndarray  #: (3, 3) of these
    weights: np.ndarray  #: (3,)
    height: float  #: of the other point above the triangle's plane
    distance: float

    def carried(self, positions: np.ndarray) -> np.ndarray:
        """The point on the same triangle with other positions of the vertices, at the same height."""
        frame = _frame(positions[self.corners])
        return self.weights @ positions[self.corners] + self.height * frame[:, 2]

    def normal(self, positions: np.ndarray) -> np.ndarray:
        """Of the same triangle with other positions of the vertices."""
        return _frame(positions[self.corners])[:, 2]

    def turned(self, vector: np.ndarray, positions: np.ndarray) -> np.ndarray:
        """The vector as it is there, of the same length."""
        coordinates = np.linalg.lstsq(_frame(self.places), vector, rcond=None)[0]
        turned = _frame(positions[self.corners]) @ coordinates
        length = np.linalg.norm(turned)
        return vector if length == 0 else turned * (np.linalg.norm(vector) / length)


class _Surface:
    """Closest points of a mesh."""

    def __init__(self, mesh: bpy.types.Mesh, points: np.ndarray):
        self.points = points
        self._triangles, _loops = loop_triangles(mesh)
        sizes = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_total", sizes)
        self._first = np.concatenate([[0], np.cumsum(sizes - 2)])  # triangles follow each other as polygons do
        copy = bmesh.new()
        copy.from_mesh(mesh, use_shape_key=False)
        self._tree = BVHTree.FromBMesh(copy)
        copy.free()

    def nearest(self, point: np.ndarray) -> _Spot:
        found: Any = self._tree.find_nearest(point)
        place, polygon, distance = np.array(found[0]), found[2], found[3]
        triangles = self._triangles[self._first[polygon] : self._first[polygon + 1]]
        weights = [_barycentric(self.points[corners], place) for corners in triangles]
        best = int(np.argmax([weight.min() for weight in weights]))
        inside = np.clip(weights[best], 0.0, None)
        corners = triangles[best]
        places = self.points[corners]
        height = float((point - place) @ _frame(places)[:, 2])
        return _Spot(corners, places, inside / inside.sum(), height, distance)


def _rest_positions(own: bpy.types.Mesh, seen: bpy.types.Mesh) -> np.ndarray | None:
    """(n, 3) where each vertex of the seen mesh is at rest, if that is known."""
    attribute = seen.attributes.get(REST)
    if attribute is not None and attribute.domain == "POINT":
        values = np.empty(len(seen.vertices) * 3, np.float32)
        attribute.data.foreach_get("vector", values)
        return values.reshape(-1, 3).astype(np.float64)
    same = len(own.vertices) == len(seen.vertices) and len(own.loops) == len(seen.loops)
    return _positions(own) if same else None


def _positions(mesh: bpy.types.Mesh) -> np.ndarray:
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(np.float64)


def _frame(corners: np.ndarray) -> np.ndarray:
    """Columns: two edges of a triangle and its unit normal."""
    a, b = corners[1] - corners[0], corners[2] - corners[0]
    normal = np.cross(a, b)
    return np.column_stack([a, b, normal / (np.linalg.norm(normal) or 1.0)])


def _barycentric(corners: np.ndarray, place: np.ndarray) -> np.ndarray:
    edges = _frame(corners)[:, :2]
    along = np.linalg.lstsq(edges, place - corners[0], rcond=None)[0]
    return np.array([1.0 - along.sum(), *along])
