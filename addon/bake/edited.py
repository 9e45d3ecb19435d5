# SPDX-License-Identifier: GPL-3.0-or-later
"""The edits of a design, applied to what was solved from it, before it is written."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from ..cache.layout import EDITS
from ..edits import edit_steps, notes_of
from ..edits.report import OFF, EditReport, Status
from ..model.design import FIELDS, Design
from ..solve import Solution
from ..work import Steps, scaled


@dataclass(frozen=True, eq=False)
class EditedSolution:
    """The solution after the edits, and what became of them, by field where the fields differ."""

    solution: Solution
    reports: tuple[EditReport, ...]
    notes: tuple[str, ...]


def edited_solution(solution: Solution, design: Design) -> Steps[EditedSolution]:
    """Both fields with the edits that act on them; one that is both is edited once."""
    if not any(edit.enabled for edit in design.edits):
        return EditedSolution(solution, (), ())
    fields = dict(solution.fields)
    same = fields[FIELDS[0]] is fields[FIELDS[1]] and all(edit.field == "both" for edit in design.edits)
    reports: list[EditReport] = []
    notes: list[str] = []
    parts = [FIELDS] if same else [(name,) for name in FIELDS]
    for number, names in enumerate(parts):
        edits = [edit if edit.field in ("both", names[0]) else replace(edit, enabled=False) for edit in design.edits]
        steps = edit_steps(fields[names[0]], edits)
        edited = yield from scaled(steps, number / len(parts), (number + 1) / len(parts))
        for name in names:
            fields[name] = edited.field
        reports += edited.reports
        which = "" if same else f"{names[0]}: "
        notes += [which + note for note in notes_of(edited.reports)]
    return EditedSolution(replace(solution, fields=fields), tuple(reports), tuple(notes))


@dataclass(frozen=True)
class Outcome:
    """What became of one edit of a design in both fields. reason: what was not done, and why."""

    status: Status
    reason: str


def outcomes_of(edited: EditedSolution, design: Design) -> tuple[Outcome, ...]:
    """One for each edit of the design. Applied: in a field at least that it acts on."""
    count = len(design.edits)
    return tuple(_outcome(edited.reports[number::count]) for number in range(count))


def _outcome(reports: tuple[EditReport, ...]) -> Outcome:
    acting = [report for report in reports if report.reason != OFF]
    if not acting:
        return Outcome("refused", OFF)
    applied = any(report.status == "applied" for report in acting)
    reason = next((report.reason for report in acting if report.reason), "")
    return Outcome("applied" if applied else "refused", reason)


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
