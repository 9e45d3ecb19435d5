# SPDX-License-Identifier: GPL-3.0-or-later
"""Where there is no field: faces whose three vectors are exactly zero, such as a part that no element reaches.

The core still finds one of its infinitesimal zeros per face there, by the rule that makes indices add up on every mesh.
They are nothing that flows: they are left out here, and the region is reported instead.

    region = region_without_field(mesh.triangles, values)
    found = with_field(topology, region)                 # what of a native Topology has a field
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.words import Json

#: A point belongs to a region when that much of its barycentric weight lies on the region's vertices.
INSIDE = 1.0 - 1e-6


@dataclass(frozen=True, eq=False)
class Region:
    """Faces without a field."""

    faces: np.ndarray  #: (m,) bool: all three vectors are zero
    vertices: np.ndarray  #: (n,) bool: belongs to such a face
    triangles: np.ndarray  #: (m, 3) of the mesh
    parts: int  #: whole connected parts of the mesh among them
    zeros: int  #: vertices with a vector of zero, also those that belong to no such face

    @property
    def note(self) -> str:
        """One sentence; empty where the field is everywhere."""
        count = int(self.faces.sum())
        if not count:
            return ""
        where = (
            f", among them {self.parts} whole part{'s' if self.parts != 1 else ''} of the mesh," if self.parts else ""
        )
        return f"{count} of {len(self.faces)} faces{where} have no field; there is nothing to find there"

    def to_json(self) -> dict[str, Json]:
        return {"faces": int(self.faces.sum()), "vertices": self.zeros, "parts": self.parts}

    def holds(self, face: int, barycentric: np.ndarray) -> bool:
        """Whether a point of the surface lies in it or on its border."""
        return float(np.asarray(barycentric)[self.vertices[self.triangles[face]]].sum()) > INSIDE


def region_without_field(mesh: native.TriangleMesh, values: np.ndarray) -> Region:
    """values: (n, 3), or (k, n, 3) for a field over λ, where zero means zero at every λ; (…, n) complex likewise."""
    triangles = np.asarray(mesh.triangles)
    still = values == 0.0
    still = still if np.iscomplexobj(values) else still.all(axis=-1)
    still = still.reshape(-1, still.shape[-1]).all(axis=0)
    faces = still[triangles].all(axis=1)
    vertices = np.zeros(len(still), bool)
    vertices[triangles[faces]] = True
    moving = np.unique(np.asarray(mesh.components)[~still])
    return Region(faces, vertices, triangles, int(mesh.component_count) - len(moving), int(still.sum()))


@dataclass(frozen=True, eq=False)
class Separatrix:
    """As native.Separatrix."""

    saddle: int
    outgoing: bool
    end: tuple[str, int | None]
    points: np.ndarray
    length: float


@dataclass(frozen=True, eq=False)
class Topology:
    """What of a native.Topology has a field, numbered anew; the members are the same, and the region besides."""

    fixed_points: Sequence[native.FixedPoint]
    boundary_points: Sequence[native.BoundaryPoint]
    periodic_orbits: Sequence[native.PeriodicOrbit]
    separatrices: Sequence[Separatrix]
    links: Sequence[tuple[tuple[str, int | None], tuple[str, int | None], tuple[int, ...]]]
    region: Region


def with_field(topology: native.Topology, region: Region) -> Topology:
    """The topology without the fixed points of a region, and without what begins or ends at one of them."""
    points = [i for i, p in enumerate(topology.fixed_points) if not region.holds(p.face, p.barycentric)]
    number = {old: new for new, old in enumerate(points)}

    def stays(entity: tuple[str, int | None]) -> bool:
        return entity[0] != "fixed_point" or entity[1] in number

    def renumbered(entity: tuple[str, int | None]) -> tuple[str, int | None]:
        kind, index = entity
        return (kind, number[index]) if kind == "fixed_point" and index is not None else (kind, index)

    curves = [i for i, s in enumerate(topology.separatrices) if s.saddle in number]
    curve = {old: new for new, old in enumerate(curves)}
    separatrices = []
    for old in curves:
        s = topology.separatrices[old]
        end = renumbered(s.end) if stays(s.end) else ("none", None)
        separatrices.append(Separatrix(number[s.saddle], s.outgoing, end, np.asarray(s.points), s.length))
    links = [
        (renumbered(source), renumbered(target), tuple(curve[i] for i in along))
        for source, target, along in topology.links
        if stays(source) and stays(target)
    ]
    return Topology(
        [topology.fixed_points[i] for i in points],
        [p for p in topology.boundary_points if not region.faces[p.face]],
        topology.periodic_orbits,
        separatrices,
        links,
        region,
    )
