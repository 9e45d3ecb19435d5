# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface in a mesh of any kind: an oriented 2-manifold, on which a field can be solved.

    surface = manifold(mesh, weld=1e-5)
    values = solve_on(surface.mesh)             # (k, …) at the vertices of the surface
    surface.to_mesh(values)                     # (n, …) at those of the mesh; nan where the surface has none

Border vertices in one place are joined (seams, split faces). Where an edge has more than two faces, the two that
continue each other best stay together and the others are cut off; a vertex whose faces touch in it alone becomes one
for each fan. Faces without area are flipped away or left out, as are faces that are there twice. A mesh that is a
surface already stays as it is, vertex for vertex.
"""

from dataclasses import dataclass

import numpy as np

from . import cutting, flat_faces, outward
from .mesh_data import MeshData
from .near_points import joined


@dataclass(frozen=True, eq=False)
class Remarks:
    """What of a mesh is no surface: numbers of its vertices and triangles."""

    welded: np.ndarray  #: vertices that were joined to others
    flat: np.ndarray  #: triangles without area
    repeated: np.ndarray  #: triangles that are there twice
    inward: np.ndarray  #: triangles of closed parts whose normals point inward
    crowded: np.ndarray  #: vertices of edges with more than two faces
    pinched: np.ndarray  #: vertices whose faces touch in them alone

    @property
    def clean(self) -> bool:
        return not any(len(found) for found in vars(self).values())

    def line(self) -> str:
        """One sentence; empty for a mesh without faults."""
        parts = []
        if len(self.inward):
            parts.append(f"turned {_count(len(self.inward), 'triangle', 'triangles')} whose normals point inward")
        if len(self.welded):
            parts.append(f"joined {_count(len(self.welded), 'vertex', 'vertices')} of seams and split faces")
        around = [
            (len(self.crowded), "vertex", "vertices", " of edges with more than two faces"),
            (len(self.pinched), "vertex", "vertices", " where parts touch in a point"),
            (len(self.flat), "triangle", "triangles", " without area"),
            (len(self.repeated), "face", "faces", " that lie on others"),
        ]
        told = [f"{_count(number, one, many)}{what}" for number, one, many, what in around if number]
        if told:
            parts.append(f"solved around {', '.join(told)}")
        return " and ".join(parts)


@dataclass(frozen=True, eq=False)
class Manifold:
    """A surface and how it belongs to the mesh that it was made from."""

    mesh: MeshData
    number: np.ndarray  #: (n,) the vertex of the surface that stands for each vertex of the mesh, -1 for none
    origin: np.ndarray  #: (k,) the vertex of the mesh that each vertex of the surface comes from
    corners: np.ndarray  #: (m, 3) 3 · triangle + corner of the mesh, for each corner of the surface
    faces: int  #: triangles of the mesh
    joints: np.ndarray  #: (3 m,) the vertex of the mesh at each corner of the surface, the same for joined ones
    remarks: Remarks

    @property
    def same(self) -> bool:
        """Whether the mesh is the surface itself."""
        return self.remarks.clean

    @property
    def triangles(self) -> np.ndarray:
        """(m,) the triangle of the mesh that each triangle of the surface comes from."""
        return self.corners[:, 0] // 3

    def to_surface(self, values: np.ndarray) -> np.ndarray:
        """(n, …) at the vertices of the mesh → (k, …)."""
        return values if self.same else values[self.origin]

    def to_mesh(self, values: np.ndarray) -> np.ndarray:
        """(k, …) at the vertices of the surface → (n, …); 0 at vertices that are not of it."""
        if self.same:
            return values
        carried = values[self.number]
        carried[self.number < 0] = 0
        return carried

    def of_triangles(self, values: np.ndarray) -> np.ndarray:
        """(m,) integers of the surface's triangles → of the mesh's, -1 where the surface has none."""
        if self.same:
            return values
        found = np.full(self.faces, -1, np.int32)
        found[self.triangles] = values
        return found


def manifold(mesh: MeshData, weld: float = 0.0) -> Manifold:
    """The surface of a mesh. weld: distance within which border vertices are joined, over the mesh's diagonal."""
    points = mesh.vertices
    if not _is_readable(points, mesh.triangles):
        return _same(mesh)  # the core names what is wrong
    merged, triangles, corners, flat = flat_faces.without_flat(points, mesh.triangles)
    triangles, corners, repeated = flat_faces.without_repeated(triangles, corners)
    if not len(triangles):
        return _same(mesh)
    mates, crowded = cutting.shared_edges(points, triangles)
    shared = mates.copy()
    near = joined(points, triangles, mates, weld * float(np.linalg.norm(np.ptp(points, axis=0))))
    cutting.glue_borders(points, near[triangles], triangles, mates)
    fans = cutting.fans(triangles, mates)
    inward = outward.inward(points, triangles, mates)
    faults = len(flat) + len(repeated) + len(crowded) + inward.sum()
    if not faults and _one_fan_each(triangles, fans, len(points)):
        return _same(mesh)
    remarks = Remarks(
        welded=_glued(triangles, shared, mates, near),
        flat=flat,
        repeated=repeated,
        inward=np.unique(corners[inward] // 3),
        crowded=crowded,
        pinched=_pinched(triangles, cutting.fans(triangles, shared), crowded),
    )
    return _cut_out(mesh, merged, triangles, corners, fans, mates, inward, remarks)


def _is_readable(points: np.ndarray, triangles: np.ndarray) -> bool:
    return bool(np.isfinite(points).all() and triangles.min() >= 0 and triangles.max() < len(points))


def _same(mesh: MeshData) -> Manifold:
    vertices, none = np.arange(len(mesh.vertices)), np.zeros(0, np.int64)
    corners = np.arange(3 * len(mesh.triangles)).reshape(-1, 3)
    remarks = Remarks(none, none, none, none, none, none)
    return Manifold(mesh, vertices, vertices, corners, len(corners), mesh.triangles.ravel(), remarks)


def _one_fan_each(triangles: np.ndarray, fans: np.ndarray, count: int) -> bool:
    """Whether every vertex has one fan, and every fan one vertex."""
    vertices = triangles.ravel()
    fan_of, vertex_of = np.empty(count, np.int64), np.empty(len(fans), np.int64)
    fan_of[vertices], vertex_of[fans] = fans, vertices
    return bool((fan_of[vertices] == fans).all() and (vertex_of[fans] == vertices).all())


def _cut_out(mesh, merged, triangles, corners, fans, mates, inward, remarks: Remarks) -> Manifold:
    """The surface of those fans: one vertex for each, in the order of the mesh, and its inward triangles turned."""
    flat = triangles.ravel()
    first = np.full(fans.max() + 1, len(merged))
    np.minimum.at(first, fans, flat)
    used = np.unique(fans)
    order = used[np.lexsort((used, first[used]))]
    rank = np.empty(fans.max() + 1, np.int64)
    rank[order] = np.arange(len(order))
    surface = rank[fans].reshape(-1, 3)
    number = _stand_ins(mesh.vertices, flat, surface, mates)
    surface[inward], corners = surface[inward][:, ::-1], np.where(inward[:, None], corners[:, ::-1], corners)
    uv_layers = {name: uv.reshape(-1, 2)[corners] for name, uv in mesh.uv_layers.items()}
    data = MeshData(mesh.vertices[first[order]], surface, uv_layers)
    joints = merged[mesh.triangles.ravel()[corners.ravel()]]
    return Manifold(data, number[merged], first[order], corners, len(mesh.triangles), joints, remarks)


def _stand_ins(points: np.ndarray, vertices: np.ndarray, surface: np.ndarray, mates: np.ndarray) -> np.ndarray:
    """(n,) for each vertex of the mesh that of its fans which belongs to the largest piece of the surface."""
    places = points[vertices].reshape(-1, 3, 3)
    area = np.linalg.norm(np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]), axis=1)
    piece = cutting.pieces(len(surface), mates)
    size = np.bincount(piece, area)[piece].repeat(3)
    number = np.full(len(points), -1)
    order = np.lexsort((-surface.ravel(), size))  # the last that is written stays: largest piece, first fan
    number[vertices[order]] = surface.ravel()[order]
    return number


def _glued(triangles: np.ndarray, before: np.ndarray, mates: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Vertices of the edges that were glued, that others stand for."""
    glued = np.flatnonzero((before < 0) & (mates >= 0))
    ends = np.unique(triangles.ravel()[np.concatenate([glued, cutting.after(glued)])])
    return ends[near[ends] != ends]


def _pinched(triangles: np.ndarray, fans: np.ndarray, crowded: np.ndarray) -> np.ndarray:
    """Vertices with several fans, besides those of edges with more than two faces."""
    pairs = np.unique(triangles.ravel().astype(np.int64) * len(fans) + fans)
    vertices, counts = np.unique(pairs // len(fans), return_counts=True)
    return np.setdiff1d(vertices[counts > 1], crowded)


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"
