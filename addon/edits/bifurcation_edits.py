# SPDX-License-Identifier: GPL-3.0-or-later
"""Removing and moving one bifurcation of a field over λ, verified by following all fixed points anew (thesis 11.2.2).

edited = run(bifurcation_steps(field, edit))     # edit.type: remove_bifurcation or move_bifurcation

Regions around the paths grow ring by ring, over which the field is changed. The first field is taken in which that
bifurcation is as wanted, every other one and every other path is where it was, and none is new. Else nothing changes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.edits import Edit
from ..model.errors import InputError
from ..work import Steps, result_of
from .bifurcations import Changed, History, described, faces_of_paths, fault_after, find_bifurcation, whole_life
from .lambda_fill import between, fade, grown, inner_weights, shifted, smoothest
from .single import SampleEdit, change_between

#: Regions that are tried: rings of faces around the paths.
RINGS = (2, 3, 4, 6, 8, 11, 15)
#: How often the place and λ of a moved bifurcation are corrected.
CORRECTIONS = 3


@dataclass(frozen=True, eq=False)
class Plan:
    """What an edit does: the paths that it changes, within a window of λ, by values (s, n) for a region of faces."""

    paths: Collection[int]
    window: tuple[float, float]
    changed: Changed
    fill: Callable[[np.ndarray, np.ndarray], np.ndarray]  #: faces, correction (λ, x, y, z) -> values
    wanted: tuple[np.ndarray, float] | None = None  #: place and λ of a moved bifurcation


def bifurcation_steps(field: native.ParameterizedField, edit: Edit) -> Steps[tuple[np.ndarray, SampleEdit]]:
    """Values (s, n) after the edit, or as they were, and what is known of it."""
    values = np.asarray(field.values)
    try:
        if len(values) < 3:
            raise InputError("bifurcations are edited over λ; the field has fewer than three samples")
        before = yield from _history(field, values, 0.0, 0.2)
        plan = _removal(before, edit) if edit.type == "remove_bifurcation" else _movement(before, edit)
        after, faces = yield from _verified(before, plan)
    except (InputError, native.SolverError) as fault:
        return values, SampleEdit(field.sample(0), False, str(fault))
    angle, length = change_between(values, after)
    done = SampleEdit(
        field.sample(0),
        True,
        faces=tuple(int(face) for face in faces),
        fill="harmonic",
        largest_angle=angle,
        largest_length=length,
    )
    return after, done


def _history(field: native.ParameterizedField, values: np.ndarray, begin: float, end: float) -> Steps[History]:
    whole = native.ParameterizedField(field.mesh, field.lambdas, values)
    tracking = yield from result_of(native.start_tracking(whole), begin, "Following fixed points over λ", end)
    return History(whole, tracking)


def _verified(before: History, plan: Plan) -> Steps[tuple[np.ndarray, np.ndarray]]:
    """Values and region of the first field that is as wanted. Raises InputError with what was wrong with the last."""
    others = [k for k in range(len(before.tracking.paths)) if k not in plan.paths]
    core = faces_of_paths(before, plan.paths, plan.window)
    walls = faces_of_paths(before, others, plan.window)
    if np.intersect1d(core, walls).size:
        raise InputError(_in_the_way(before, others, core, plan.window))
    fault, known = "there is no room around its paths", 0
    for number, rings in enumerate(RINGS):
        faces = grown(before.field.mesh, core, rings, walls)
        if len(faces) == known:
            break
        known = len(faces)
        correction = np.zeros(4)
        for attempt in range(CORRECTIONS if plan.wanted else 1):
            done = 0.2 + 0.8 * (number + attempt / CORRECTIONS) / len(RINGS)
            try:
                values = plan.fill(faces, correction)
            except InputError as problem:
                fault = str(problem)
                break
            after = yield from _history(before.field, values, done, done)
            fault = fault_after(before, after, plan.changed)
            if not fault and plan.wanted is not None:
                fault, error = _distance(before, after, plan)
                correction = correction + error
            if not fault:
                return values, faces
    raise InputError(f"no change of the field around the paths was verified: {fault}; give it another reach")


def _in_the_way(history: History, others: Collection[int], core: np.ndarray, window: tuple[float, float]) -> str:
    for k in others:
        if np.intersect1d(faces_of_paths(history, [k], window), core).size:
            path = history.tracking.paths[k]
            return (
                f"the {path.kind} that lives from λ = {path.lambdas[0]:.3g} to {path.lambdas[-1]:.3g} passes through "
                "the faces of these paths; cancel it first, or use a finer mesh"
            )
    return "other fixed points are in the way"


# Removing -------------------------------------------------------------------------------------------------------------


def _removal(before: History, edit: Edit) -> Plan:
    number = find_bifurcation(before, edit.at, edit.lam[0])
    if edit.until is not None:
        return _closed_gap(before, number, find_bifurcation(before, edit.until.at, edit.until.lam), edit.reach)
    event = before.tracking.bifurcations[number]
    first, last = whole_life(before, number)
    gone = [k for k, each in enumerate(before.tracking.bifurcations) if set(_paths(each)) <= set(event.paths)]
    lambdas, values = before.lambdas, np.asarray(before.field.values)
    weights = fade(lambdas, first, last, edit.reach)
    if not weights.any():  # the pair lives between two samples only
        weights[np.argmin(np.abs(lambdas - 0.5 * (first + last)))] = 1.0
    window = _window(lambdas, weights > 0.0)

    def fill(faces: np.ndarray, _: np.ndarray) -> np.ndarray:
        chosen = np.flatnonzero(weights)
        smooth = smoothest(before.field, faces, range(chosen[0], chosen[-1] + 1))
        result = values.copy()
        for j in chosen:
            result[j] += weights[j] * (smooth[j - chosen[0]] - values[j])
        return result

    return Plan(event.paths, window, Changed(event.paths, gone), fill)


def _closed_gap(before: History, vanish: int, appear: int, reach: float) -> Plan:
    """The pair that vanishes and appears again lives on in between."""
    if before.tracking.bifurcations[appear].lam < before.tracking.bifurcations[vanish].lam:
        vanish, appear = appear, vanish
    first, second = (before.tracking.bifurcations[k] for k in (vanish, appear))
    if (first.kind, second.kind) != ("annihilation", "creation") or first.node != second.node:
        raise InputError(
            f"the {described(before, vanish)} and the {described(before, appear)} are no gap: a pair must vanish "
            "first and one of the same kinds appear again later"
        )
    lambdas, values = before.lambdas, np.asarray(before.field.values)
    paths = (*first.paths, *second.paths)
    lives = [before.tracking.paths[k].lambdas for k in paths]
    inside = (lambdas > first.lam - reach) & (lambdas < second.lam + reach)
    if not inside.any():
        raise InputError("the gap lies between two samples of λ; solve or import the field with more samples")
    a, b = int(np.flatnonzero(inside)[0]) - 1, int(np.flatnonzero(inside)[-1]) + 1
    if (
        a < 0
        or b >= len(lambdas)
        or lambdas[a] < max(lives[0][0], lives[1][0])
        or lambdas[b] > min(lives[2][-1], lives[3][-1])
    ):
        raise InputError(f"the reach of {reach:g} goes beyond the life of the pairs; give a smaller one")
    events = (vanish, appear)
    gone = [k for k, each in enumerate(before.tracking.bifurcations) if set(_paths(each)) <= set(paths)]
    kept = len(gone) - len(events)

    window = (float(lambdas[a]), float(lambdas[b]))

    def fill(faces: np.ndarray, _: np.ndarray) -> np.ndarray:
        weights = _weights(before, paths, window, faces)
        result = values.copy()
        for j in range(a + 1, b):
            part = (lambdas[j] - lambdas[a]) / (lambdas[b] - lambdas[a])
            result[j] += weights * ((1.0 - part) * values[a] + part * values[b] - values[j])
        return result

    return Plan(paths, window, Changed(paths, gone, paths_left=2, bifurcations_left=kept), fill)


def _weights(history: History, paths: Collection[int], window: tuple[float, float], faces: np.ndarray) -> np.ndarray:
    """(n,): 1 at the paths, 0 on the border of a region around them."""
    mesh, core = history.field.mesh, faces_of_paths(history, paths, window)
    return inner_weights(mesh, faces, _corners(mesh, core), _depth(mesh, faces, core))


def _corners(mesh: native.TriangleMesh, faces: np.ndarray) -> np.ndarray:
    """(k, 3): the positions of all vertices of some faces."""
    return np.asarray(mesh.vertices)[np.unique(np.asarray(mesh.triangles)[faces])]


def _depth(mesh: native.TriangleMesh, faces: np.ndarray, core: np.ndarray) -> float:
    """About how far a region reaches beyond its core, mesh units: of areas, as if around one point."""
    areas = np.asarray(mesh.face_areas)
    whole, inner = float(areas[faces].sum()), float(areas[np.intersect1d(core, faces)].sum())
    return max(np.sqrt(whole / np.pi) - np.sqrt(inner / np.pi), float(mesh.mean_edge_length))


def _paths(event: native.Bifurcation) -> list[int]:
    return [k for k in event.paths if k >= 0]


def _window(lambdas: np.ndarray, chosen: np.ndarray) -> tuple[float, float]:
    """Of samples and the steps beside them, in which the field changes as well."""
    at = np.flatnonzero(chosen)
    return float(lambdas[max(at[0] - 1, 0)]), float(lambdas[min(at[-1] + 1, len(lambdas) - 1)])


# Moving ---------------------------------------------------------------------------------------------------------------


def _movement(before: History, edit: Edit) -> Plan:
    number = find_bifurcation(before, edit.at, edit.lam[0])
    event = before.tracking.bifurcations[number]
    lambdas, values, mesh = before.lambdas, np.asarray(before.field.values), before.field.mesh
    to_lam = event.lam if edit.to_lam is None else edit.to_lam
    place = np.asarray(event.position)
    target = place if not edit.has_to else _on_surface(mesh, edit.to)
    reach = edit.reach or max(abs(to_lam - event.lam), 2.0 / max(len(lambdas) - 1, 1))
    first, last = min(event.lam, to_lam) - reach, max(event.lam, to_lam) + reach
    _check_window(before, number, first, last)
    inside = np.flatnonzero((lambdas > first) & (lambdas < last))
    if not len(inside):
        raise InputError("no sample of λ lies within the reach; give a larger one")
    window = _window(lambdas, (lambdas > first) & (lambdas < last))
    a, b = (int(np.searchsorted(lambdas, end)) for end in window)

    def fill(faces: np.ndarray, correction: np.ndarray) -> np.ndarray:
        result = values.copy()
        if to_lam != event.lam:
            weights = _weights(before, event.paths, window, faces)
            knots = [window[0], float(np.clip(to_lam + correction[0], *window)), window[1]]
            from_lam = np.interp(lambdas[a : b + 1], knots, [window[0], event.lam, window[1]])
            for j in range(a + 1, b):
                result[j] += weights * (between(lambdas, values, from_lam[j - a]) - values[j])
        offset = target - place
        if np.linalg.norm(offset) > 0.0:
            core = _corners(mesh, faces_of_paths(before, event.paths, window))
            weights = inner_weights(mesh, faces, core, 3.0 * float(np.linalg.norm(offset)))
            over = fade(lambdas, to_lam, to_lam, reach)
            for near in map(int, np.flatnonzero(over)):
                result[near] = shifted(mesh, result[near], faces, over[near] * weights, offset + correction[1:])
        return result

    changed = Changed(event.paths, (number,), paths_left=2, bifurcations_left=1)
    return Plan(event.paths, window, changed, fill, wanted=(target, to_lam))


def _on_surface(mesh: native.TriangleMesh, place: tuple[float, float, float]) -> np.ndarray:
    faces, barycentric, _ = mesh.closest_points(np.array([place]))
    return np.asarray(barycentric)[0] @ np.asarray(mesh.vertices)[np.asarray(mesh.triangles)[faces[0]]]


def _check_window(before: History, number: int, first: float, last: float) -> None:
    event = before.tracking.bifurcations[number]
    if first < 0.0 or last > 1.0:
        raise InputError(f"the reach goes beyond λ: from {first:.3g} to {last:.3g}; give a smaller one")
    for k, other in enumerate(before.tracking.bifurcations):
        if k != number and set(_paths(other)) & set(event.paths) and first <= other.lam <= last:
            raise InputError(
                f"the {described(before, k)} lies within the reach, on one of the same paths; give a smaller reach"
            )


def _distance(before: History, after: History, plan: Plan) -> tuple[str, np.ndarray]:
    """Whether the moved bifurcation is within half an edge and half a step of λ of its target; what is missing."""
    assert plan.wanted is not None
    place, lam = plan.wanted
    known = {round(event.lam, 9) for event in before.tracking.bifurcations}
    kind = before.tracking.bifurcations[next(iter(plan.changed.bifurcations))].kind
    found = [event for event in after.tracking.bifurcations if event.kind == kind and round(event.lam, 9) not in known]
    if not found:
        return "it would stay where it is", np.zeros(4)
    event = min(
        found, key=lambda each: abs(each.lam - lam) + float(np.linalg.norm(each.position - place)) / before.size
    )
    missing = np.concatenate([[lam - event.lam], place - np.asarray(event.position)])
    near = float(np.linalg.norm(missing[1:])) / before.field.mesh.mean_edge_length
    half_step = 0.5 * float(np.diff(before.lambdas).max())
    if near <= 0.5 and abs(missing[0]) <= half_step:
        return "", missing
    return f"it would be at λ = {event.lam:.3g}, {near:.2g} edges from the target", missing
