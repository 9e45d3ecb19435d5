# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits applied to a field over λ, in order, each verified or refused: field, edits → field and a report for each.

edited = run(edit_steps(field, edits))       # field: native.ParameterizedField
edited.field, edited.reports[0].status, edited.reports[0].reason

An edit acts at the sample nearest to its λ. With a reach its change of the vectors fades out over the samples around.
Verified is the sample itself; over λ the bifurcations before and after are counted, and new ones are said: a pair that
is cancelled at one λ alone ends before it and begins again behind it. Only the window of λ is read and changed that an
edit touches, and with a memory only what was changed since is done again.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..model.edits import BIFURCATION_TYPES, Edit
from ..model.words import Json
from ..work import Steps, result_of, scaled
from .bifurcation_edits import bifurcation_steps
from .lambda_fill import fading
from .memory import EditMemory, Made, key_of
from .report import OFF, EditReport, turned_off
from .single import SampleEdit, edit_sample
from .transforming import transformed

#: Where an edit is made and its bifurcations are counted, in the fractions of its steps.
MADE = 0.5


@dataclass(frozen=True, eq=False)
class EditedField:
    """The field after all edits, and what became of each."""

    field: native.ParameterizedField
    reports: tuple[EditReport, ...]


def edit_steps(
    field: native.ParameterizedField,
    edits: Sequence[Edit],
    *,
    orientation: native.ParameterizedField | None = None,
    memory: EditMemory | None = None,
) -> Steps[EditedField]:
    """Applies the edits that are turned on. Never raises for an edit that cannot be made: its report says why.

    orientation: what a transform stretches along, at the same λ; None: the field itself, before each edit.
    memory: of earlier calls, for this one and later ones.
    """
    values, lambdas = np.array(field.values), np.asarray(field.lambdas)
    memory = memory or EditMemory(limit=0)
    reports: list[EditReport] = []
    for number, edit in enumerate(edits):
        if not edit.enabled:
            reports.append(turned_off(edit))
            continue
        window = _window(lambdas, edit)
        part = native.ParameterizedField(field.mesh, lambdas[window], values[window])
        along = None if orientation is None else np.asarray(orientation.values)[window]
        turned = part if along is None else native.ParameterizedField(field.mesh, lambdas[window], along)
        key = key_of(field.mesh, edit, *(np.asarray(array) for array in (part.lambdas, part.values, turned.values)))
        made = memory.find(key)
        if made is None:
            made = yield from scaled(_made(part, edit, turned), number / len(edits), (number + 1) / len(edits))
            memory.keep(key, made)
        values[window] = made.values
        reports.append(made.report)
    return EditedField(native.ParameterizedField(field.mesh, lambdas, values), tuple(reports))


_HOW = {"applied": "applied in part", "refused": "refused"}


def notes_of(reports: Sequence[EditReport]) -> tuple[str, ...]:
    """One line for each edit that was refused, was applied in part, or made bifurcations."""
    notes = []
    for number, report in enumerate(reports, 1):
        if report.reason and report.reason != OFF:
            notes.append(f"edit {number} ({report.type}) was {_HOW[report.status]}: {report.reason}")
        if report.new_bifurcations > 0:
            count = report.new_bifurcations
            cure = "" if report.type == "transform" else "; give it another reach, or edit the whole life of the pair"
            notes.append(
                f"edit {number} ({report.type}) makes {count} new bifurcation{'s' if count > 1 else ''} over λ{cure}"
            )
    return tuple(notes)


def _made(field: native.ParameterizedField, edit: Edit, orientation: native.ParameterizedField) -> Steps[Made]:
    """The samples of a window after one edit."""
    before, began = np.asarray(field.values), time.perf_counter()
    if edit.type == "transform":
        after, done = transformed(field, edit, orientation)
        values, report = np.array(after.values), EditReport.of(edit, list(edit.lam), [done])
    elif edit.type in BIFURCATION_TYPES:
        values, done = yield from scaled(bifurcation_steps(field, edit), 0.0, MADE)
        report = EditReport.of(edit, [edit.lam[0]], [done])
    else:
        values = before.copy()
        report = yield from scaled(_apply(field, values, edit), 0.0, MADE)
    if len(before) > 1 and not np.array_equal(before, values):
        counting = _bifurcations(field.mesh, np.asarray(field.lambdas), (before, values))
        report = replace(report, bifurcations=(yield from scaled(counting, MADE, 1.0)))
    return Made(values, replace(report, seconds=time.perf_counter() - began))


def _apply(field: native.ParameterizedField, values: np.ndarray, edit: Edit) -> Steps[EditReport]:
    """Changes values (s, n) in place where the edit is applied."""
    lambdas = np.asarray(field.lambdas)
    chosen = _samples(lambdas, edit.lam)
    done: list[SampleEdit] = []
    changes: dict[int, np.ndarray] = {}
    for place, j in enumerate(chosen):
        steps = edit_sample(field.sample(j), edit)
        result = yield from scaled(steps, place / len(chosen), (place + 1) / len(chosen))
        done.append(result)
        if result.applied:
            changes[j] = np.asarray(result.field.values) - values[j]
            values[j] = result.field.values
    _fade(lambdas, values, changes, edit.reach)
    return EditReport.of(edit, [float(lambdas[j]) for j in chosen], done)


def _bifurcations(
    mesh: native.TriangleMesh, lambdas: np.ndarray, both: tuple[np.ndarray, np.ndarray]
) -> Steps[tuple[int, int]]:
    """Numbers of bifurcations of two fields over λ."""
    counts = []
    for place, values in enumerate(both):
        job = native.start_tracking(native.ParameterizedField(mesh, lambdas, values))
        tracking = yield from result_of(job, 0.5 * place, "Following fixed points over λ", 0.5 * (place + 1))
        counts.append(len(tracking.bifurcations))
    return counts[0], counts[1]


def _window(lambdas: np.ndarray, edit: Edit) -> slice:
    """The samples that an edit may change, and one more on each side: what lies between is changed as well."""
    if edit.type in BIFURCATION_TYPES:
        return slice(0, len(lambdas))
    if edit.transform is not None:
        first = int(np.searchsorted(lambdas, edit.transform.begin))
        return slice(max(first - 1, 0), len(lambdas))
    chosen = lambdas[_samples(lambdas, edit.lam)]
    inside = np.flatnonzero((lambdas >= chosen[0] - edit.reach) & (lambdas <= chosen[-1] + edit.reach))
    return slice(max(int(inside[0]) - 1, 0), int(inside[-1]) + 2)


def _samples(lambdas: np.ndarray, lam: tuple[float, float]) -> list[int]:
    """The samples of a range of λ, or the nearest one where it holds none."""
    inside = np.flatnonzero((lambdas >= lam[0]) & (lambdas <= lam[1]))
    if len(inside):
        return [int(j) for j in inside]
    return [int(np.argmin(np.abs(lambdas - 0.5 * (lam[0] + lam[1]))))]


def _fade(lambdas: np.ndarray, values: np.ndarray, changes: dict[int, np.ndarray], reach: float) -> None:
    """Adds the change of the nearest edited sample, with a weight that falls smoothly from 1 to 0 at the reach."""
    if not changes or reach <= 0.0:
        return
    edited = np.array(sorted(changes))
    for j, lam in enumerate(lambdas):
        nearest = int(edited[np.argmin(np.abs(lambdas[edited] - lam))])
        distance = abs(float(lam - lambdas[nearest]))
        if j not in changes and distance < reach:
            values[j] += fading(distance, reach) * changes[nearest]


def to_json(reports: Sequence[EditReport]) -> list[Json]:
    """The reports of a command."""
    return [report.to_json() for report in reports]
