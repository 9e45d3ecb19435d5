# SPDX-License-Identifier: GPL-3.0-or-later
"""Bifurcations of a field over λ as edits name them: which one is meant, which paths it joins, and whether after an
edit all others are as they were (thesis 11.2.2)."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.errors import InputError

#: A bifurcation must be within this part of the mesh's size and this distance in λ of where an edit says that it is.
NEAR, NEAR_LAM = 0.1, 0.1
#: Others are unmoved that are within this part of the mesh's size, and this distance in λ, of where they were.
UNMOVED = 1e-6


@dataclass(frozen=True, eq=False)
class History:
    """A field over λ and its fixed points followed over it."""

    field: native.ParameterizedField
    tracking: native.Tracking

    @property
    def lambdas(self) -> np.ndarray:
        return np.asarray(self.field.lambdas)

    @property
    def size(self) -> float:
        return float(self.field.mesh.size)


def described(history: History, number: int) -> str:
    """What messages call a bifurcation: annihilation of a sink and a saddle at λ = 0.4 near (0, 1, 0)."""
    event = history.tracking.bifurcations[number]
    place = ", ".join(f"{value:.3g}" for value in event.position)
    return f"{event.kind} of a {event.node} and a saddle at λ = {event.lam:.3g} near ({place})"


def find_bifurcation(history: History, at: tuple[float, ...], lam: float) -> int:
    """The number of the creation or annihilation nearest to a place and λ. Raises InputError where none is near."""
    events = history.tracking.bifurcations
    numbers = [number for number, event in enumerate(events) if event.kind != "hopf"]
    if not numbers:
        raise InputError("fixed points neither appear nor vanish in pairs over λ here; follow them over λ again")
    away = {k: float(np.linalg.norm(np.asarray(events[k].position) - at)) / history.size for k in numbers}
    nearest = min(numbers, key=lambda k: away[k] + abs(events[k].lam - lam))
    if away[nearest] > NEAR or abs(events[nearest].lam - lam) > NEAR_LAM:
        place = ", ".join(f"{value:g}" for value in at)
        raise InputError(
            f"there is no bifurcation near ({place}) at λ = {lam:g}; the nearest is the {described(history, nearest)}: "
            "follow the fixed points over λ again and choose what is there"
        )
    return nearest


def whole_life(history: History, number: int) -> tuple[float, float]:
    """First and last λ between which the two paths of a bifurcation live. Raises InputError unless they begin and end
    together: in two bifurcations, or in one and at an end of λ."""
    event = history.tracking.bifurcations[number]
    paths = [history.tracking.paths[k] for k in event.paths]
    creation = event.kind == "creation"
    others = [_other_end(history, number, k) for k in event.paths]
    if others[0] != others[1]:
        for k, other in zip(event.paths, others, strict=True):
            if isinstance(other, int):
                what = "ends" if creation else "begins"
                raise InputError(
                    f"the {history.tracking.paths[k].kind} of the {described(history, number)} {what} with another "
                    f"partner, in the {described(history, other)}; remove that one first"
                )
    if "boundary" in others or others[0] != others[1]:
        raise InputError(
            f"a path of the {described(history, number)} leaves the surface over its boundary; this bifurcation cannot "
            "be removed"
        )
    return min(float(path.lambdas[0]) for path in paths), max(float(path.lambdas[-1]) for path in paths)


def _other_end(history: History, number: int, path: int) -> str | int:
    """Where else a path of a bifurcation ends: another bifurcation, or boundary, first, last."""
    creation = history.tracking.bifurcations[number].kind == "creation"
    end = history.tracking.paths[path].end if creation else history.tracking.paths[path].begin
    if end not in ("creation", "annihilation"):
        return end
    return next(
        k
        for k, event in enumerate(history.tracking.bifurcations)
        if k != number and event.kind == end and path in event.paths
    )


def faces_of_paths(history: History, paths: Collection[int], window: tuple[float, float]) -> np.ndarray:
    """Ascending: the faces that these paths cross within a window of λ."""
    found = [np.zeros(0, np.int32)]
    for k in paths:
        path = history.tracking.paths[k]
        lambdas = np.asarray(path.lambdas)
        first = max(int(np.searchsorted(lambdas, window[0], "right")) - 1, 0)
        found.append(np.asarray(path.faces)[first : int(np.searchsorted(lambdas, window[1])) + 1])
    return np.unique(np.concatenate(found))


@dataclass(frozen=True)
class Changed:
    """What an edit may take away and add: numbers of paths, and of bifurcations, before; how many of each after."""

    paths: Collection[int]
    bifurcations: Collection[int]
    paths_left: int = 0
    bifurcations_left: int = 0


def fault_after(before: History, after: History, changed: Changed) -> str:
    """What is wrong after an edit of λ; empty where all others are as they were and what was wanted is there."""
    lost = _unmatched(_events(before, changed.bifurcations), _events(after, ()), before.size)
    if lost:
        return f"the {described(before, lost[0])} would move or vanish"
    kept = len(before.tracking.bifurcations) - len(changed.bifurcations)
    new = len(after.tracking.bifurcations) - kept - changed.bifurcations_left
    if new > 0:
        return f"{new} new bifurcation{'s' if new > 1 else ''} would appear"
    if new < 0:
        return "the bifurcation would vanish"
    moved = _moved_path(before, after, changed.paths)
    if moved is not None:
        return f"the {before.tracking.paths[moved].kind} that lives from λ = {_life(before, moved)} would move"
    if len(after.tracking.paths) != len(before.tracking.paths) - len(changed.paths) + changed.paths_left:
        return "other fixed points would appear or vanish"
    return ""


def _life(history: History, path: int) -> str:
    lambdas = history.tracking.paths[path].lambdas
    return f"{lambdas[0]:.3g} to {lambdas[-1]:.3g}"


def _events(history: History, without: Collection[int]) -> dict[int, native.Bifurcation]:
    return {k: event for k, event in enumerate(history.tracking.bifurcations) if k not in without}


def _unmatched(before: dict[int, native.Bifurcation], after: dict[int, native.Bifurcation], size: float) -> list[int]:
    free = dict(after)
    lost = []
    for k, event in before.items():
        same = next((j for j, other in free.items() if _same_event(event, other, size)), None)
        if same is None:
            lost.append(k)
        else:
            del free[same]
    return lost


def _same_event(a: native.Bifurcation, b: native.Bifurcation, size: float) -> bool:
    near = np.linalg.norm(np.asarray(a.position) - b.position) <= UNMOVED * size
    return bool(a.kind == b.kind and a.node == b.node and abs(a.lam - b.lam) <= UNMOVED and near)


def _moved_path(before: History, after: History, without: Collection[int]) -> int | None:
    free = list(after.tracking.paths)
    for k, path in enumerate(before.tracking.paths):
        if k in without:
            continue
        same = next((j for j, other in enumerate(free) if _same_path(path, other, before.size)), None)
        if same is None:
            return k
        del free[same]
    return None


def _same_path(a: native.TrackedPath, b: native.TrackedPath, size: float) -> bool:
    if a.index != b.index or len(a.lambdas) != len(b.lambdas):
        return False
    same_life = np.abs(np.asarray(a.lambdas) - b.lambdas).max() <= UNMOVED
    return bool(same_life and np.abs(np.asarray(a.positions) - b.positions).max() <= UNMOVED * size)
