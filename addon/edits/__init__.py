# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits applied to a field over λ, in order, each verified or refused: field, edits → field and a report for each.

edited = run(edit_steps(field, edits))       # field: native.ParameterizedField
edited.field, edited.reports[0].status, edited.reports[0].reason

An edit acts at the sample nearest to its λ. With a reach its change of the vectors fades out over the samples around;
verified is the sample itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.edits import Edit
from ..model.words import Json
from ..work import Steps, scaled
from .report import EditReport, not_applied
from .single import SampleEdit, edit_sample


@dataclass(frozen=True, eq=False)
class EditedField:
    """The field after all edits, and what became of each."""

    field: native.ParameterizedField
    reports: tuple[EditReport, ...]


def edit_steps(field: native.ParameterizedField, edits: Sequence[Edit]) -> Steps[EditedField]:
    """Applies the edits that are turned on. Never raises for an edit that cannot be made: its report says why."""
    values = np.array(field.values)
    lambdas = np.asarray(field.lambdas)
    reports: list[EditReport] = []
    for number, edit in enumerate(edits):
        if not edit.enabled:
            reports.append(not_applied(edit, "off", "the edit is turned off"))
            continue
        steps = _apply(field.mesh, lambdas, values, edit)
        report = yield from scaled(steps, number / len(edits), (number + 1) / len(edits))
        reports.append(report)
    return EditedField(native.ParameterizedField(field.mesh, lambdas, values), tuple(reports))


def notes_of(reports: Sequence[EditReport]) -> tuple[str, ...]:
    """One line for each edit that was refused, or applied in part."""
    return tuple(
        f"edit {number} ({report.type}) was {report.status}: {report.reason}"
        for number, report in enumerate(reports, 1)
        if report.reason and report.status != "off"
    )


def _apply(mesh: native.TriangleMesh, lambdas: np.ndarray, values: np.ndarray, edit: Edit) -> Steps[EditReport]:
    """Changes values (s, n) in place where the edit is applied."""
    chosen = _samples(lambdas, edit.lam)
    done: list[SampleEdit] = []
    changes: dict[int, np.ndarray] = {}
    for place, j in enumerate(chosen):
        steps = edit_sample(native.VectorField(mesh, values[j]), edit)
        result = yield from scaled(steps, place / len(chosen), (place + 1) / len(chosen))
        done.append(result)
        if result.applied:
            changes[j] = np.asarray(result.field.values) - values[j]
            values[j] = result.field.values
    _fade(lambdas, values, changes, edit.reach)
    return EditReport.of(edit, [float(lambdas[j]) for j in chosen], done)


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
            values[j] += np.cos(0.5 * np.pi * distance / reach) ** 2 * changes[nearest]


def to_json(reports: Sequence[EditReport]) -> list[Json]:
    """The reports of a command."""
    return [report.to_json() for report in reports]
