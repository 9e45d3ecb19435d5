# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain edits → the list of a field, and what became of each at the last solve."""

from pathlib import Path

import bpy

from ...bake.edited import read_outcomes
from ...model.edits import Edit


def add_edit(obj: bpy.types.Object, edit: Edit, name: str) -> None:
    """Append an edit that acts at one λ, and make it the active one."""
    field = obj.stormfield
    item = field.edits.add()
    item.name, item.type, item.field, item.enabled = name, edit.type, edit.field, edit.enabled
    item.lam, item.reach = edit.lam[0], edit.reach
    if edit.type == "simplify":
        item.keep = edit.keep
    else:
        first, second = edit.entities
        item.first_kind, item.first_at = first.kind, first.at
        item.second_kind, item.second_at = second.kind, second.at
    field.active_edit = len(field.edits) - 1


def show_outcomes(obj: bpy.types.Object, folder: Path) -> None:
    """Write beside each edit what the solve that made a λ cache says of it; nothing where the cache does not say."""
    for edit in obj.stormfield.edits:
        edit.status = edit.reason = ""
    enabled = [edit for edit in obj.stormfield.edits if edit.enabled]
    outcomes = read_outcomes(folder)
    if len(outcomes) == len(enabled):
        for edit, outcome in zip(enabled, outcomes, strict=True):
            edit.status, edit.reason = outcome.status, outcome.reason
