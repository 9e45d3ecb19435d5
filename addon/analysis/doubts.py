# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist should know of a solve although it went well, in their words, with what cures it.

for doubt in doubts_of(surface, design, {"sf_advection": vectors}): doubt.kind, doubt.text, doubt.amount
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Literal

import numpy as np

from .. import native
from ..model.design import Design, Element
from ..model.manifold import Remarks
from ..model.words import Json

#: coarse: subdivide; no_element: leave parts out, or fill them; inward: turn the normals; faults: look at them.
DoubtKind = Literal["coarse", "no_element", "inward", "faults"]
#: Edges across a storm's radius: below the first it is said that the mesh is too coarse; the cure gives the second.
TOO_COARSE, ENOUGH = 2.0, 3.0
#: Points of an element at which the mesh is looked at.
PLACES = 5


@dataclass(frozen=True)
class Doubt:
    kind: DoubtKind
    text: str  #: one sentence
    amount: int = 0  #: coarse: how often to subdivide; otherwise the parts concerned

    def to_json(self) -> dict[str, Json]:
        return asdict(self)


def doubts_of(
    surface: native.TriangleMesh, design: Design, fields: Mapping[str, np.ndarray], remarks: Remarks | None = None
) -> list[Doubt]:
    """fields: (n, 3) vectors by name, each of one λ at which elements act. remarks: of the mesh that the surface was
    made from."""
    inward = _inward(surface) if remarks is None else _turned(remarks)
    found = (_coarse(surface, design), _no_element(surface, fields), inward, _faults(remarks))
    return [doubt for doubt in found if doubt is not None]


def parts_without_field(surface: native.TriangleMesh, fields: Mapping[str, np.ndarray]) -> list[int]:
    """Connected parts on which one of the fields is zero."""
    parts = np.asarray(surface.components)
    without: set[int] = set()
    for values in fields.values():
        moving = np.unique(parts[np.asarray(values).any(axis=1)])
        without |= set(range(surface.component_count)) - set(moving.tolist())
    return sorted(without)


def _coarse(surface: native.TriangleMesh, design: Design) -> Doubt | None:
    """The storm with the fewest edges across its radius, where those are too few."""
    storms = [element for element in design.elements if element.type == "singular"]
    lengths = mean_edge_lengths(np.asarray(surface.vertices), np.asarray(surface.triangles))
    measured = [(storm, _edge_at(surface, lengths, storm)) for storm in storms]
    doubtful = [(storm, edge) for storm, edge in measured if not _fits(storm.least_radius, edge, design.settings.edge)]
    if not doubtful:
        return None
    worst, edge = max(doubtful, key=lambda pair: pair[1] / pair[0].least_radius)
    times = math.ceil(math.log2(ENOUGH * edge / worst.least_radius))
    return Doubt(
        "coarse",
        f"The mesh is too coarse for '{worst.name}': its radius is {worst.least_radius:.2g}, edges there are "
        f"{edge:.2g}. Subdivide {times} time{'s' if times != 1 else ''}, or make the radius larger",
        times,
    )


def _fits(radius: float, edge: float, solved_edge: float) -> bool:
    """Whether edges, mesh units, are short enough for a storm. solved_edge: of the mesh refined inside the solve, 0 for
    none; the vertices of the mesh itself show a storm only that is no smaller than their edges."""
    solved = min(edge, solved_edge) if solved_edge > 0.0 and radius >= edge else edge
    return radius >= TOO_COARSE * solved


def mean_edge_lengths(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n,): mean length of the edges at each vertex, mesh units; 0 without any."""
    total, count = np.zeros(len(vertices)), np.zeros(len(vertices))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        length = np.linalg.norm(vertices[triangles[:, a]] - vertices[triangles[:, b]], axis=1)
        for corner in (a, b):
            total += np.bincount(triangles[:, corner], length, len(vertices))
            count += np.bincount(triangles[:, corner], minlength=len(vertices))
    return total / np.maximum(count, 1)


def _edge_at(surface: native.TriangleMesh, lengths: np.ndarray, element: Element) -> float:
    """The longest edges that the element meets on its way."""
    chosen = np.unique(np.linspace(0, len(element.points) - 1, PLACES).round().astype(int))
    faces, _barycentric, _distances = surface.closest_points(np.array(element.points, np.float64)[chosen])
    return float(lengths[np.asarray(surface.triangles)[faces]].mean(axis=1).max())


def _no_element(surface: native.TriangleMesh, fields: Mapping[str, np.ndarray]) -> Doubt | None:
    parts = parts_without_field(surface, fields)
    if not parts:
        return None
    few = f"{len(parts)} of the {surface.component_count} parts of the mesh"
    text = (
        f"{few} have no element, so nothing flows on them"
        if len(parts) > 1
        else f"{few} has no element, so nothing flows on it"
    )
    return Doubt("no_element", text, len(parts))


def _inward(surface: native.TriangleMesh) -> Doubt | None:
    """Closed parts whose faces point inward, where left and right turns look exchanged."""
    vertices, triangles = np.asarray(surface.vertices), np.asarray(surface.triangles)
    parts = np.asarray(surface.components)[triangles[:, 0]]
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    volume = np.bincount(parts, np.einsum("ij,ij->i", a, np.cross(b, c)), surface.component_count)
    inward = [part for part in np.flatnonzero(volume < 0.0) if _is_closed(triangles[parts == part])]
    if not inward:
        return None
    what = (
        "The faces point inward"
        if len(inward) == surface.component_count
        else f"The faces of {len(inward)} parts point inward"
    )
    return Doubt("inward", f"{what}, so storms that turn left look as if they turned right", len(inward))


def _turned(remarks: Remarks) -> Doubt | None:
    """Closed parts that pointed inward and were turned for the solve."""
    if not len(remarks.inward):
        return None
    text = "The faces of closed parts point inward; the field is as seen from outside, so that left turns left there"
    return Doubt("inward", text, len(remarks.inward))


def _faults(remarks: Remarks | None) -> Doubt | None:
    """What of the mesh is no surface."""
    line = "" if remarks is None else replace(remarks, inward=remarks.inward[:0]).line()
    return Doubt("faults", f"The solve {line}") if line else None


def _is_closed(triangles: np.ndarray) -> bool:
    """Whether every edge has two faces."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())
