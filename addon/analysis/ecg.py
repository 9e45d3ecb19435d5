# SPDX-License-Identifier: GPL-3.0-or-later
"""The entity connection graph (thesis 2.2.2, 3.2): Topology → EntityGraph, and its words in JSON.

topology = with_field(native.start_topology(field).result(), region_without_field(mesh, vectors))
graph = entity_graph(topology, lam=0.5)             # fixed points first, then periodic orbits, as in the topology
content = topology_json(topology, graph)            # fixed_points, periodic_orbits, separatrices, links, index_sum ...
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from .. import native
from ..model.words import Json
from .entities import Entity, EntityGraph, EntityKind, Link, Row
from .no_field import Separatrix, Topology
from .quiet import is_storm

TITLE = "Entity connection graph"

#: Row and first letter of the name by kind. A center and a point without a kind of its own stand with the saddles.
ROWS: dict[EntityKind, tuple[Row, str]] = {
    "source": ("repelling", "R"),
    "repelling": ("repelling", "R"),
    "sink": ("attracting", "A"),
    "attracting": ("attracting", "A"),
    "saddle": ("saddle", "S"),
    "center": ("saddle", "C"),
    "degenerate": ("saddle", "D"),
}


def entity_graph(topology: Topology, lam: float = 0.0) -> EntityGraph:
    """Entity i is fixed point i; the periodic orbits follow. Links carry their separatrices in the flow's direction.

    Strength in 1/s: of a fixed point the square root of |det J|, of an orbit the rate
    |log multiplier| / period at which neighbours come nearer or leave.
    """
    count: Counter[str] = Counter()
    entities: list[Entity] = []

    def named(kind: EntityKind) -> tuple[int, str, EntityKind, Row]:
        """The first members of the next entity."""
        row, letter = ROWS[kind]
        count[letter] += 1
        return len(entities), f"{letter}{count[letter]}", kind, row

    for point in topology.fixed_points:
        entities.append(
            Entity(
                *named(point.kind),
                position=np.asarray(point.position),
                strength=float(np.sqrt(abs(np.linalg.det(point.jacobian)))),
                info={
                    "index": int(point.index),
                    "rotation": float(point.rotation),
                    "face": int(point.face),
                    "storm": is_storm(np.asarray(point.jacobian)),
                },
            )
        )
    for orbit in topology.periodic_orbits:
        curve = np.asarray(orbit.points)
        entities.append(
            Entity(
                *named(orbit.kind),
                position=curve[0],
                curve=curve,
                strength=_rate(orbit.multiplier, orbit.period),
                info={
                    "length": float(orbit.length),
                    "period": float(orbit.period),
                    "multiplier": float(orbit.multiplier),
                    "band": bool(orbit.band),
                },
            )
        )
    curves = [_with_flow(separatrix) for separatrix in topology.separatrices]
    links = tuple(
        Link(_number(topology, source), _number(topology, target), tuple(curves[i] for i in separatrices))
        for source, target, separatrices in topology.links
    )
    return EntityGraph(TITLE, tuple(entities), links, lam)


def topology_json(topology: Topology, graph: EntityGraph) -> dict[str, Json]:
    """The entities and links of `stormfield analyze` (docs/formats.md). Links name the places of their ends in
    entities: the fixed points, then the periodic orbits."""
    points, orbits = topology.fixed_points, topology.periodic_orbits
    inside = sum(int(point.index) for point in points)
    boundary = sum(float(point.index) for point in topology.boundary_points)
    names = [entity.name for entity in graph.entities]
    return {
        "fixed_points": [_fixed_point(point, name) for point, name in zip(points, names, strict=False)],
        "boundary_points": [
            {"position": _floats(point.position), "face": int(point.face), "index": float(point.index)}
            for point in topology.boundary_points
        ],
        "periodic_orbits": [_orbit(orbit, name) for orbit, name in zip(orbits, names[len(points) :], strict=True)],
        "separatrices": [_separatrix(topology, separatrix, names) for separatrix in topology.separatrices],
        "links": [
            {
                "source": link.source,
                "target": link.target,
                "names": [names[link.source], names[link.target]],
                "separatrices": list(separatrices),
            }
            for link, (_, _, separatrices) in zip(graph.links, topology.links, strict=True)
        ],
        "index_sum": inside,
        "boundary_index_sum": boundary,
        "zero_regions": topology.region.to_json(),
    }


def _number(topology: Topology, entity: tuple[str, int | None]) -> int:
    """Place among the entities."""
    kind, index = entity
    assert index is not None
    return index if kind == "fixed_point" else len(topology.fixed_points) + index


def _rate(multiplier: float, period: float) -> float:
    return abs(float(np.log(max(multiplier, 1e-300)))) / period if period > 0.0 else 0.0


def _with_flow(separatrix: Separatrix) -> np.ndarray:
    points = np.asarray(separatrix.points)
    return points if separatrix.outgoing else points[::-1]


def _floats(array: np.ndarray) -> Json:
    return np.asarray(array, np.float64).tolist()


def _fixed_point(point: native.FixedPoint, name: str) -> dict[str, Json]:
    return {
        "name": name,
        "position": _floats(point.position),
        "face": int(point.face),
        "barycentric": _floats(point.barycentric),
        "kind": str(point.kind),
        "index": int(point.index),
        "rotation": float(point.rotation),
        "jacobian": _floats(point.jacobian),
        "eigenvalues": [[float(value.real), float(value.imag)] for value in point.eigenvalues],
        "eigenvectors": [_floats(vector) for vector in point.eigenvectors],
        "separatrix_directions": [
            {"direction": _floats(direction), "outgoing": bool(outgoing)}
            for direction, outgoing in point.separatrix_directions
        ],
    }


def _orbit(orbit: native.PeriodicOrbit, name: str) -> dict[str, Json]:
    return {
        "name": name,
        "kind": str(orbit.kind),
        "length": float(orbit.length),
        "period": float(orbit.period),
        "multiplier": float(orbit.multiplier),
        "band": bool(orbit.band),
        "points": _floats(orbit.points),
    }


def _separatrix(topology: Topology, separatrix: Separatrix, names: list[str]) -> dict[str, Json]:
    kind, index = separatrix.end
    place = None if index is None else _number(topology, separatrix.end)
    return {
        "saddle": int(separatrix.saddle),
        "outgoing": bool(separatrix.outgoing),
        "end": {"kind": str(kind), "entity": place, "name": None if place is None else names[place]},
        "length": float(separatrix.length),
        "points": _floats(separatrix.points),
    }
