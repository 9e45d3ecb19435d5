# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits applied to the two fields of an object: of a design what was solved from it, before it is written."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from .. import native
from ..cache.layout import EDITS
from ..edits import edit_steps, notes_of
from ..edits.memory import EditMemory
from ..edits.report import OFF, EditReport, Status
from ..model.design import FIELDS, Design, FieldName
from ..model.edits import Edit
from ..model.errors import InputError
from ..model.words import Json
from ..solve import Solution
from ..work import Steps, scaled

Fields = Mapping[FieldName, "native.ParameterizedField"]


@dataclass(frozen=True, eq=False)
class EditedFields:
    """Both fields after the edits, and for each edit what became of it, by field; one that is both is edited once."""

    fields: Fields
    reports: tuple[Mapping[FieldName, EditReport], ...] = ()
    notes: tuple[str, ...] = ()


def edited_fields(fields: Fields, edits: Sequence[Edit], memory: EditMemory | None = None) -> Steps[EditedFields]:
    """Each field with the edits that act on it; advection is stretched along the edited orientation."""
    changed = dict(fields)
    one = fields[FIELDS[0]] is fields[FIELDS[1]] and all(edit.field == "both" for edit in edits)
    reports: list[dict[FieldName, EditReport]] = [{} for _ in edits]
    notes: list[str] = []
    for number, name in enumerate(FIELDS[:1] if one else FIELDS):
        acting = [edit if edit.field in ("both", name) else replace(edit, enabled=False) for edit in edits]
        along = None if number == 0 else changed[FIELDS[0]]
        steps = edit_steps(fields[name], acting, orientation=along, memory=memory)
        edited = yield from scaled(steps, number / 2, (number + 1) / 2)
        changed[name] = edited.field
        for own, report in zip(reports, edited.reports, strict=True):
            own[name] = report
        notes += [("" if one else f"{name}: ") + note for note in notes_of(edited.reports)]
    if one:
        changed[FIELDS[1]] = changed[FIELDS[0]]
    return EditedFields(changed, tuple(reports), tuple(notes))


@dataclass(frozen=True, eq=False)
class EditedSolution:
    """The solution after the edits, what became of each, and what the artist should know."""

    solution: Solution
    outcomes: tuple[Outcome, ...] = ()
    notes: tuple[str, ...] = ()


def edited_solution(solution: Solution, design: Design, memory: EditMemory | None = None) -> Steps[EditedSolution]:
    """The solution of a design with its edits."""
    if not any(edit.enabled for edit in design.edits):
        return EditedSolution(solution, tuple(Outcome("refused", OFF) for _ in design.edits))
    edits = [_on_surface(edit, solution) for edit in design.edits]
    edited = yield from edited_fields(solution.fields, edits, memory)
    outcomes = tuple(outcome_of(reports) for reports in edited.reports)
    return EditedSolution(replace(solution, fields=edited.fields), outcomes, edited.notes)


def _on_surface(edit: Edit, solution: Solution) -> Edit:
    """The edit with faces of the surface that was solved in place of those of the mesh."""
    if not edit.region.faces or solution.carried is None:
        return edit
    try:
        faces = tuple(int(face) for face in solution.carried.faces(edit.region.faces))
    except InputError:
        return edit  # which is refused by that number, as on any surface
    return replace(edit, region=replace(edit.region, faces=faces))


@dataclass(frozen=True)
class Outcome:
    """What became of one edit in both fields. reason: what was not done, and why."""

    status: Status
    reason: str


def outcome_of(reports: Mapping[FieldName, EditReport]) -> Outcome:
    """Applied: in a field at least that the edit acts on."""
    acting = [report for report in reports.values() if report.reason != OFF]
    if not acting:
        return Outcome("refused", OFF)
    applied = any(report.status == "applied" for report in acting)
    reason = next((report.reason for report in acting if report.reason), "")
    return Outcome("applied" if applied else "refused", reason)


def report_json(reports: Mapping[FieldName, EditReport]) -> dict[str, Json]:
    """The report of one edit; of two fields that of advection, with the outcome in both and `fields`."""
    acting = {name: report for name, report in reports.items() if report.reason != OFF} or dict(reports)
    content = [*acting.values()][-1].to_json()
    if len(acting) < 2:
        return content
    each = {name: report.to_json() for name, report in acting.items()}
    return {**content, **asdict(outcome_of(acting)), "fields": each}


def write_outcomes(folder: Path, outcomes: tuple[Outcome, ...]) -> None:
    """Beside the samples, so that a cache that is found again says it too."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / EDITS).write_text(json.dumps([asdict(outcome) for outcome in outcomes], indent=1), encoding="utf-8")


def read_outcomes(folder: Path) -> tuple[Outcome, ...]:
    """Empty where the cache has no edits, or does not say."""
    try:
        found = json.loads((folder / EDITS).read_text(encoding="utf-8"))
        return tuple(Outcome(entry["status"], entry["reason"]) for entry in found)
    except (OSError, ValueError, TypeError, KeyError):
        return ()
