# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubts of the last solve with the buttons that cure them, below Solve."""

import bpy

from ..analysis.doubts import Doubt
from ..scene.write import doubts
from ..session import coarse_mesh
from .panel_parts import text_lines

#: Operators that cure each kind, with their icons.
CURES = {
    "coarse": (("stormfield.subdivide_mesh", "MOD_SUBSURF"),),
    "no_element": (("stormfield.fill_parts", "ADD"), ("stormfield.leave_out_parts", "HIDE_ON")),
    "faults": (("stormfield.select_faults", "RESTRICT_SELECT_OFF"),),
    "inward": (("stormfield.fix_normals", "NORMALS_FACE"),),
}


def draw(context: bpy.types.Context, layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    found = doubts.read(obj)
    coarse = "" if any(doubt.kind == "coarse" for doubt in found) else coarse_mesh.why_too_coarse(obj)
    if coarse:  # what can be said before a solve
        found.append(Doubt("coarse", coarse))
    for doubt in found:
        box = layout.box()
        text_lines(context, box, doubt.text, icon="ERROR")
        row = box.row(align=True)
        for operator, icon in CURES[doubt.kind]:
            row.operator(operator, icon=icon)
