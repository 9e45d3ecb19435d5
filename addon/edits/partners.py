# SPDX-License-Identifier: GPL-3.0-or-later
"""With what an entity can be cancelled, and what a list would look like after a simplification: found out step by step.

steps = partner_steps(field, entities, 3)         # yields as each other entity is planned
steps = simplify_steps(field, entities, keep=12)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .. import native
from ..model.edits import EntityAt
from ..model.errors import InputError
from ..work import Step, Steps, result_of
from .single import Kind, entity_at, find_entity

#: Where the topology is known, in the fractions of all steps.
ANALYZED = 0.3


@dataclass(frozen=True, eq=False)
class Partner:
    """reason: why the two cannot be cancelled; empty where they can. faces: the first block that will be tried. left:
    what must remain, in words."""

    reason: str = ""
    faces: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    left: str = ""


@dataclass(frozen=True)
class Simpler:
    """vanish: places in the list of what would be gone. new: what would be there besides. count: of all after it."""

    keep: int
    vanish: frozenset[int]
    new: tuple[EntityAt, ...]
    count: int


def partner_steps(
    given: native.VectorField, entities: Sequence[EntityAt], chosen: int, found: dict[int, Partner]
) -> Steps[None]:
    """Fills `found`, by places in the list, the nearest first. Raises InputError where the chosen one is not there."""
    topology = yield from result_of(native.start_topology(given), 0.0, "Following the flow", ANALYZED)
    own = find_entity(given.mesh, topology, entities[chosen])
    place = np.array(entities[chosen].at)
    away = [float(np.linalg.norm(np.array(entity.at) - place)) for entity in entities]
    for done, other in enumerate(np.argsort(away, kind="stable").tolist()):
        if other == chosen:
            continue
        try:
            plan = native.plan_cancel(given, topology, own, find_entity(given.mesh, topology, entities[other]))
            found[other] = Partner(faces=np.asarray(plan.faces), left=plan.left)
        except InputError as fault:
            found[other] = Partner(str(fault))
        yield Step(ANALYZED + (1.0 - ANALYZED) * done / len(entities), "Finding partners")


def simplify_steps(given: native.VectorField, entities: Sequence[EntityAt], keep: int) -> Steps[Simpler]:
    """What `keep` would leave of the entities of an analysis."""
    topology = yield from result_of(native.start_topology(given), 0.0, "Following the flow", ANALYZED)
    job = native.start_simplify(given, topology, keep=keep)
    result = yield from result_of(job, ANALYZED, "Simplifying")
    before, after = _names(topology), _names(result.topology)
    gone = {before[name] for name in before.keys() - after.keys()}
    vanish = frozenset(
        place for place, entity in enumerate(entities) if find_entity(given.mesh, topology, entity) in gone
    )
    new = tuple(entity_at(result.topology, *after[name]) for name in sorted(after.keys() - before.keys()))
    return Simpler(keep, vanish, new, len(after))


def _names(topology: native.Topology) -> dict[str, tuple[Kind, int]]:
    entities: list[tuple[Kind, int]] = [("fixed_point", k) for k in range(len(topology.fixed_points))]
    entities += [("periodic_orbit", k) for k in range(len(topology.periodic_orbits))]
    return {native.entity_name(topology, entity): entity for entity in entities}
