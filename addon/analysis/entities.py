# SPDX-License-Identifier: GPL-3.0-or-later
"""The one graph of an analysis: entities (fixed points, periodic orbits, Morse sets) and their links.

The entity connection graph (thesis 3.2) and the Morse connection graph (thesis 6.2) are both an EntityGraph, so that
layout, editor, list, selection, picture and export exist once.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ..model.words import FixedPointKind, Json, MorseKind, OrbitKind

Row = Literal["repelling", "saddle", "attracting"]
EntityKind = FixedPointKind | OrbitKind | MorseKind


@dataclass(frozen=True, eq=False)
class Entity:
    """One node. Lengths in mesh units, positions in object space."""

    id: int  #: place in EntityGraph.entities
    name: str  #: short and unique: "S3" saddle, "R1" source or repelling, "A2" sink or attracting, "C4" center, ...
    kind: EntityKind
    row: Row  #: row of the three-row layout (thesis 3.2)
    position: np.ndarray  #: (3,) where a marker or label goes
    curve: np.ndarray | None = None  #: (k, 3) polyline of an orbit, closed orbits repeat their first point
    strength: float = 0.0  #: how much it matters: see the module that made it; 1/s for fixed points
    faces: np.ndarray | None = None  #: (k,) int32 faces of a Morse set
    info: Mapping[str, Json] = field(default_factory=dict)  #: more to show and export: plain JSON values


@dataclass(frozen=True, eq=False)
class Link:
    """Flow leads from one entity to another."""

    source: int
    target: int
    curves: tuple[np.ndarray, ...] = ()  #: (k, 3) each: the separatrices that make the link, in the flow's direction


@dataclass(frozen=True, eq=False)
class EntityGraph:
    """ECG or MCG of one instantaneous field. Links go with the flow: from repelling to attracting."""

    title: str  #: "Entity connection graph" or "Morse connection graph"
    entities: tuple[Entity, ...]
    links: tuple[Link, ...]
    lam: float
