# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pair an edit shall cancel, tried on the field of one sample: nothing is changed, and what is refused says why.

pair = run(pair_steps(field, first, second))      # the two, verified: InputError with the core's sentence otherwise
pair = run(pair_steps(field, first, None))        # with the nearest entity that it can be cancelled with
pair = run(weakest_steps(field))                  # the pair of least persistence that can be cancelled
"""

from __future__ import annotations

import numpy as np

from .. import native
from ..model.edits import EntityAt
from ..model.errors import InputError
from ..work import Steps, result_of
from .single import Kind, entity_at, find_entity

Pair = tuple[EntityAt, EntityAt]
Found = tuple[Kind, int]
#: Where the topology is known, in the fractions of all steps.
ANALYZED = 0.4


def pair_steps(field: native.VectorField, first: EntityAt, second: EntityAt | None) -> Steps[Pair]:
    """Two entities that can be cancelled. second: None takes the nearest one that makes a pair with the first.

    Raises InputError, in a sentence for users, where there is none or where the new field was not verified.
    """
    topology = yield from result_of(native.start_topology(field), 0.0, "Following the flow", ANALYZED)
    a = find_entity(field.mesh, topology, first)
    b = _nearest_partner(field, topology, a) if second is None else find_entity(field.mesh, topology, second)
    job = native.start_cancel_pair(field, topology, a, b)
    result = yield from result_of(job, ANALYZED, "Verifying the edit")
    if not result.applied:
        raise InputError(result.reason)
    return entity_at(topology, *a), entity_at(topology, *b)


def weakest_steps(field: native.VectorField) -> Steps[Pair]:
    """The linked pair of least persistence among those that can be cancelled. Raises InputError where there is none."""
    topology = yield from result_of(native.start_topology(field), 0.0, "Following the flow", ANALYZED)
    found = _entities(topology)
    job = native.start_simplify(field, topology, keep=max(len(found) - 1, 0))
    result = yield from result_of(job, ANALYZED, "Cancelling the weakest pair")
    done = next((step for step in result.steps if step.applied), None)
    if done is None:
        why = f"; the weakest is refused: {result.steps[0].reason}" if result.steps else ""
        raise InputError(f"no pair of the field can be cancelled{why}")
    names = {native.entity_name(topology, entity): entity for entity in found}
    a, b = (names[name] for name in done.pair.split(" and "))
    return entity_at(topology, *a), entity_at(topology, *b)


def _nearest_partner(field: native.VectorField, topology: native.Topology, a: Found) -> Found:
    """The nearest entity that cancels with a. Raises InputError with the reason of the nearest where none does."""
    places = _places(topology, a)

    def distance(b: Found) -> float:
        return float(np.linalg.norm(places[:, None] - _places(topology, b)[None], axis=2).min())

    reason = "the field has nothing else"
    for number, b in enumerate(sorted((b for b in _entities(topology) if b != a), key=distance)):
        try:
            native.plan_cancel(field, topology, a, b)
        except InputError as fault:
            reason = str(fault) if number == 0 else reason
        else:
            return b
    raise InputError(f"the {native.entity_name(topology, a)} has no partner to be cancelled with: {reason}")


def _entities(topology: native.Topology) -> list[Found]:
    points: list[Found] = [("fixed_point", k) for k in range(len(topology.fixed_points))]
    return points + [("periodic_orbit", k) for k in range(len(topology.periodic_orbits))]


def _places(topology: native.Topology, entity: Found) -> np.ndarray:
    """(k, 3)"""
    kind, number = entity
    if kind == "fixed_point":
        return np.asarray(topology.fixed_points[number].position)[None]
    return np.asarray(topology.periodic_orbits[number].points)
