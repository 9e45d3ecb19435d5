# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of one mesh on another that is nearly the same: after an edit, until it is solved again.

    folder = run(transfer_steps(open_cache(old), mesh, root, polygons))

Each vertex takes the vectors at the closest point of the old surface, turned as its normal is turned. Parts of the new
mesh that lie away from the old surface as a whole have no field.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import native
from ..cache import fields
from ..cache.field_cache import FieldCache, FieldCacheWriter
from ..cache.plan import MeshIdentity, Plan
from ..model.design import FIELDS, FieldName
from ..model.manifold import Manifold
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..solve import Solution
from ..solve.carried import Carried
from ..version import VERSION
from ..work import Step, Steps, scaled
from .unfinished import unfinished

#: Parts of the new mesh that nowhere come closer to the old one than this part of its diagonal have no field.
AWAY = 0.05
#: Where reading ends and writing begins, in the fractions of all steps.
READ_END = 0.4


def transfer_steps(cache: FieldCache, mesh: MeshData, root: Path, polygons: Polygons | None = None) -> Steps[Path]:
    """Writes a λ cache of `mesh` into a folder of root from one of another mesh; returns that folder."""
    plan = _plan(cache, mesh)
    target = root / plan.folder_name("lambda")
    writer = FieldCacheWriter(target, mesh, plan.times, plan.settings, polygons=polygons, resume=True)
    missing = yield from unfinished(writer, range(len(plan.times)))
    if missing:
        solution = yield from scaled(_carried(cache, mesh), 0.0, READ_END)
        yield Step(READ_END, "Writing the samples", notes=solution.notes)
        yield from scaled(writer.write_all(fields.attributes_of(solution)), READ_END, 1.0)
    yield from scaled(writer.finish(), 1.0, 1.0)
    return target


def _plan(cache: FieldCache, mesh: MeshData) -> Plan:
    settings = {
        "transferred from": cache.manifest.plan.mesh.fingerprint,
        "attributes": list(fields.ATTRIBUTES),
        "stormfield": VERSION,
        **({"design": cache.settings["design"]} if "design" in cache.settings else {}),
    }
    return Plan("usd", "lambda", tuple(cache.lambdas.tolist()), MeshIdentity.of(mesh), settings)


def _carried(cache: FieldCache, mesh: MeshData) -> Steps[Solution]:
    """The fields of the cache on the surface in `mesh`, as if they were solved there."""
    old, new = fields.solved_surface(cache, cache.mesh), fields.solved_surface(cache, mesh)
    from_surface, to_surface = fields.native_mesh(old.mesh), fields.native_mesh(new.mesh)
    way = _Way.between(from_surface, to_surface)
    tangents = {
        name: np.empty((len(cache.lambdas), to_surface.vertex_count), np.complex128) for name in fields.ATTRIBUTE
    }
    for j in range(len(cache.lambdas)):
        yield Step(j / len(cache.lambdas), f"Carrying sample {j + 1} of {len(cache.lambdas)}")
        sample = cache.sample(j)
        for name in FIELDS:
            vectors = old.to_surface(sample[fields.ATTRIBUTE[name]])
            tangents[name][j] = to_surface.to_tangent(way.carry(vectors))
    carried: dict[FieldName, native.ParameterizedField] = {}
    for field in FIELDS:
        carried[field] = native.ParameterizedField(to_surface, cache.lambdas, tangents[field])
    return Solution(cache.lambdas, carried, mesh.fingerprint(), _notes(way), None, _carrier(new, to_surface))


def _carrier(surface: Manifold, mesh: native.TriangleMesh) -> Carried | None:
    return None if surface.same else Carried(surface, mesh, [])


def _notes(way: _Way) -> tuple[str, ...]:
    if way.parts_away == 0:
        return ()
    parts = "1 part" if way.parts_away == 1 else f"{way.parts_away} parts"
    return (f"{parts} of the mesh lie away from what was solved, so nothing flows there until you solve again",)


@dataclass(frozen=True, eq=False)
class _Way:
    """From the vertices of one surface to those of another."""

    corners: np.ndarray  #: (k, 3) vertices of the old surface around the closest point
    weights: np.ndarray  #: (k, 3)
    turns: np.ndarray  #: (k, 3, 3) from the old normal to the new one
    near: np.ndarray  #: (k,) whether the vertex belongs to a part that has a field
    parts_away: int

    @classmethod
    def between(cls, old: native.TriangleMesh, new: native.TriangleMesh) -> _Way:
        faces, weights, distances = old.closest_points(new.vertices)
        used = new.components >= 0
        closest = np.full(new.component_count, np.inf)
        np.minimum.at(closest, new.components[used], distances[used])
        away = closest > AWAY * float(np.linalg.norm(np.ptp(old.vertices, axis=0)))
        near = used & ~away[np.maximum(new.components, 0)]
        corners = old.triangles[faces]
        before = np.einsum("kc,kcj->kj", weights, _vertex_normals(old)[corners])
        before /= np.maximum(np.linalg.norm(before, axis=1, keepdims=True), 1e-300)
        return cls(corners, weights, _turns(before, _vertex_normals(new)), near, int(away.sum()))

    def carry(self, vectors: np.ndarray) -> np.ndarray:
        """(n, 3) float32 at the old vertices → (k, 3) float64 at the new ones."""
        found = np.einsum("kc,kcj->kj", self.weights, vectors[self.corners].astype(np.float64))
        return np.einsum("kij,kj->ki", self.turns, found) * self.near[:, None]


def _vertex_normals(mesh: native.TriangleMesh) -> np.ndarray:
    """(k, 3) unit normals, weighted by area; 0 at vertices without faces."""
    normals = np.zeros((mesh.vertex_count, 3))
    for corner in range(3):
        np.add.at(normals, mesh.triangles[:, corner], mesh.face_normals * mesh.face_areas[:, None])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0.0, length, 1.0)


def _turns(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """(k, 3, 3) the shortest rotation that takes one unit vector to another; none where they are opposite."""
    axis = np.cross(before, after)
    cosine = np.einsum("ij,ij->i", before, after)
    cross = np.zeros((len(axis), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
    cross -= cross.transpose(0, 2, 1)
    factor = 1.0 / np.maximum(1.0 + cosine, 1e-6)
    turns = np.eye(3) + cross + factor[:, None, None] * (cross @ cross)
    return np.where((cosine > -0.999)[:, None, None], turns, np.eye(3))
