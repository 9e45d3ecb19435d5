# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of edits of a field → plain data."""

import bpy

from ...model.edits import SCHEMA, Edit, edits_from_json
from ...model.words import Json


def read_edits(obj: bpy.types.Object) -> tuple[Edit, ...]:
    """Those that are turned on, in the order of the list. Raises InputError for one that cannot be."""
    enabled = [_to_json(edit) for edit in obj.stormfield.edits if edit.enabled]
    return edits_from_json({"schema": SCHEMA, "edits": enabled})


def _to_json(edit) -> dict[str, Json]:
    content: dict[str, Json] = {"type": edit.type, "lam": edit.lam, "reach": edit.reach, "field": edit.field}
    if edit.type == "simplify":
        return {**content, "keep": edit.keep}
    ends = ((edit.first_kind, edit.first_at), (edit.second_kind, edit.second_at))
    return {**content, "entities": [{"kind": kind, "at": list(at)} for kind, at in ends]}
