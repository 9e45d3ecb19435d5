# SPDX-License-Identifier: GPL-3.0-or-later
"""The Morse connection graph (thesis 2.4, 6.2): native Morse decomposition → EntityGraph, and its words in JSON.

job = native.start_morse(field, method="tau", tau=0.3)      # Job: .fraction, .cancel(), .result()
decomposition = job.result()
graph = morse_graph(decomposition, mesh, lam=0.5)           # entity i is decomposition.sets[i]
simpler = morse_graph(decomposition.simplify(eps), mesh, lam=0.5)   # geometry method: what survives errors up to eps
"""

from __future__ import annotations

import math

import numpy as np

from .. import native
from ..model.words import Json
from .entities import Entity, EntityGraph, Link, Row

TITLE = "Morse connection graph"


def morse_graph(decomposition: native.MorseDecomposition, mesh: native.TriangleMesh, lam: float = 0.0) -> EntityGraph:
    """Entities in the order of decomposition.sets, links as decomposition.edges: from repelling to attracting.

    decomposition, mesh: native MorseDecomposition and the TriangleMesh it was made on. Each entity has its faces, its
    position on the set's face nearest to the set's middle, and as strength its persistence (mesh units per second; sets
    that never merge get the greatest one of the graph). info: conley, poincare, faces, area, persistence, outflow,
    upper_bound, as in JSON.
    """
    areas, centres = mesh.face_areas, mesh.vertices[mesh.triangles].mean(axis=1)
    finite = [s.persistence for s in decomposition.sets if s.persistence is not None]
    greatest = max(finite, default=1.0)
    numbers = {"A": 0, "R": 0, "S": 0, "T": 0}
    entities = []
    for number, morse_set in enumerate(decomposition.sets):
        row, letter = row_of(morse_set), letter_of(morse_set)
        numbers[letter] += 1
        persistence = morse_set.persistence
        entities.append(
            Entity(
                id=number,
                name=f"{letter}{numbers[letter]}",
                kind=morse_set.kind,
                row=row,
                position=_middle(areas[morse_set.faces], centres[morse_set.faces]),
                strength=greatest if persistence is None else persistence,
                faces=np.asarray(morse_set.faces, np.int32),
                info={
                    "conley": [int(b) for b in morse_set.conley],
                    "poincare": int(morse_set.poincare),
                    "faces": len(morse_set.faces),
                    "area": float(areas[morse_set.faces].sum()),
                    "persistence": persistence,
                    "outflow": bool(morse_set.outflow),
                    "upper_bound": bool(decomposition.upper_bound),
                },
            )
        )
    links = tuple(Link(int(a), int(b)) for a, b in decomposition.edges)
    return EntityGraph(TITLE, tuple(entities), links, lam)


def row_of(morse_set: native.MorseSet) -> Row:
    """Thesis 2.3.2: sink-like with b0, else source-like with b2, else saddle-like."""
    b0, _, b2 = morse_set.conley
    if b0 > 0:
        return "attracting"
    return "repelling" if b2 > 0 else "saddle"


def letter_of(morse_set: native.MorseSet) -> str:
    """A, R or S by row; T for a trivial index."""
    if morse_set.kind == "trivial":
        return "T"
    return {"attracting": "A", "repelling": "R", "saddle": "S"}[row_of(morse_set)]


def morse_json(decomposition: native.MorseDecomposition, graph: EntityGraph) -> dict[str, Json]:
    """morse_sets, edges and map_edges of `stormfield morse` (docs/formats.md)."""
    return {
        "method": str(decomposition.method),
        "tau": _number(decomposition.tau),
        "refinement": decomposition.stop,
        "eps": float(decomposition.eps),
        "upper_bound": bool(decomposition.upper_bound),
        "map_edges": int(decomposition.map_edges),
        "morse_sets": [
            {
                "name": entity.name,
                "kind": entity.kind,
                "conley": entity.info["conley"],
                "poincare": entity.info["poincare"],
                "persistence": _number(entity.info["persistence"]),
                "outflow": entity.info["outflow"],
                "position": [float(x) for x in entity.position],
                "area": entity.info["area"],
                "faces": [int(f) for f in _faces(entity)],
            }
            for entity in graph.entities
        ],
        "edges": [[link.source, link.target] for link in graph.links],
    }


def _faces(entity: Entity) -> np.ndarray:
    return np.zeros(0, np.int32) if entity.faces is None else entity.faces


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _middle(areas: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """The face centre nearest to the centre of mass: always on the surface."""
    mass = (areas[:, None] * centres).sum(axis=0) / areas.sum()
    return centres[np.argmin(((centres - mass) ** 2).sum(axis=1))]
