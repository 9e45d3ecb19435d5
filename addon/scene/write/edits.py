# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain edits → the list of a field, and what became of each at the last solve."""

from pathlib import Path

import bpy

from ...bake.edited import read_outcomes
from ...model.edits import Edit


def add_edit(obj: bpy.types.Object, edit: Edit, name: str, **drawn: object) -> None:
    """Append an edit and make it the active one. drawn: members of the list's entry that the edit does not tell, such
    as the curve or the attribute that its region comes from."""
    field = obj.stormfield
    item = field.edits.add()
    item.name, item.type, item.field, item.enabled = name, edit.type, edit.field, edit.enabled
    (item.lam, item.lam_end), item.reach, item.to = edit.lam, edit.reach, edit.to
    if edit.keep:
        item.keep = edit.keep
    for which, entity in zip(("first", "second"), edit.entities, strict=False):
        setattr(item, f"{which}_kind", entity.kind)
        setattr(item, f"{which}_at", entity.at)
    if edit.region.center is not None:
        item.region, item.center, item.radius = "DISC", edit.region.center, edit.region.radius
    elif not edit.has_region:
        item.region = "ALL" if edit.type == "transform" else "DISC"
    for member, value in drawn.items():
        setattr(item, member, value)
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
