# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixed points that come from a design element carry its name.

    graph = named_graph(graph, places); tracking = named_tracking(tracking, places)

A fixed point belongs to the element within whose radius it lies. No Blender here.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .entities import EntityGraph
from .tracking import TrackedPath, Tracking

#: Most bytes of a name, to which a number may come: nodes have at most 63.
LONGEST = 54
#: λ at which paths are compared with elements.
LOOKS = 21


@dataclass(frozen=True, eq=False)
class ElementPlace:
    """Where an element that makes a fixed point is, over its life."""

    name: str
    radius: float  #: mesh units
    lam: np.ndarray  #: (k,) increasing; one for what does not move
    points: np.ndarray  #: (k, 3) object space
    ends: tuple[float, float]  #: λ where it begins and ends

    def at(self, lam: float) -> np.ndarray | None:
        if not self.ends[0] - 1e-9 <= lam <= self.ends[1] + 1e-9:
            return None
        return np.array([np.interp(lam, self.lam, self.points[:, axis]) for axis in range(3)])


def named_graph(graph: EntityGraph, places: Sequence[ElementPlace]) -> EntityGraph:
    """The graph with the names of elements for the fixed points that are nearest to them; others keep theirs.

    Names stay unique: graph and list know entities by them."""
    names: dict[int, str] = {}
    for place in places:
        position = place.at(graph.lam)
        points = [entity for entity in graph.entities if entity.curve is None and entity.id not in names]
        if position is None or not points:
            continue
        nearest = min(points, key=lambda entity: float(np.linalg.norm(entity.position - position)))
        if np.linalg.norm(nearest.position - position) <= place.radius:
            names[nearest.id] = place.name
    taken = {entity.name for entity in graph.entities if entity.id not in names}
    entities = []
    for entity in graph.entities:
        if entity.id in names:
            entity = replace(entity, name=_unique(names[entity.id], taken))
        entities.append(entity)
    return replace(graph, entities=tuple(entities))


def _unique(name: str, taken: set[str]) -> str:
    """The name, short enough for a node, with a number where it is taken; it is taken then."""
    base, number = name.encode()[:LONGEST].decode(errors="ignore"), 1
    while (found := base if number == 1 else f"{base} ({number})") in taken:
        number += 1
    taken.add(found)
    return found


def named_tracking(tracking: Tracking, places: Sequence[ElementPlace]) -> Tracking:
    """The paths with the names of the elements that they follow, one after the other."""
    followed = [_followed(path, places) for path in tracking.paths]
    taken = {path.name for path, names in zip(tracking.paths, followed, strict=True) if not names}
    paths = [
        replace(path, name=_unique(" → ".join(names), taken)) if names else path
        for path, names in zip(tracking.paths, followed, strict=True)
    ]
    return replace(tracking, paths=tuple(paths))


def _followed(path: TrackedPath, places: Sequence[ElementPlace]) -> list[str]:
    """Elements by the λ at which the path first follows them: those it is near for most of the time they share."""
    found = []
    for place in places:
        looks = np.linspace(max(path.first, place.ends[0]), min(path.last, place.ends[1]), LOOKS)
        if looks[-1] - looks[0] < 1e-3:
            continue
        pairs = [(path.at(lam), place.at(lam)) for lam in looks]
        near = sum(1 for a, b in pairs if a is not None and b is not None and np.linalg.norm(a - b) <= place.radius)
        if near > 0.5 * LOOKS:
            found.append((float(looks[0]), place.name))
    return [name for _, name in sorted(found)]
