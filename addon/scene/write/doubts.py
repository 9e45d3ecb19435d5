# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubts of the last solve (analysis/doubts.py), kept with the object so that undo brings them back with the field."""

import json
from collections.abc import Sequence

import bpy

from ...analysis.doubts import Doubt, DoubtKind


def keep(obj: bpy.types.Object, doubts: Sequence[Doubt]) -> None:
    obj.stormfield.doubts = json.dumps([doubt.to_json() for doubt in doubts]) if doubts else ""


def read(obj: bpy.types.Object) -> list[Doubt]:
    """Those that are shown: parts that the artist left out are no doubt any more."""
    written = obj.stormfield.doubts
    doubts = [Doubt(**entry) for entry in json.loads(written)] if written else []
    left_out = obj.stormfield.left_out
    return [doubt for doubt in doubts if doubt.kind != "no_element" or doubt.amount != left_out]


def find(obj: bpy.types.Object, kind: DoubtKind) -> Doubt | None:
    return next((doubt for doubt in read(obj) if doubt.kind == kind), None)


def drop(obj: bpy.types.Object, kind: DoubtKind) -> None:
    """Its cure was taken; the next solve tells whether it helped."""
    keep(obj, [doubt for doubt in read(obj) if doubt.kind != kind])
