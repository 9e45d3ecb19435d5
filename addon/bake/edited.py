# SPDX-License-Identifier: GPL-3.0-or-later
"""The edits of a design, applied to what was solved from it, before it is written."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..edits import edit_steps, notes_of
from ..edits.report import EditReport
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
