# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubts of the last solve below Solve: a line that unfolds to the whole sentence, and the buttons that cure it."""

import bpy

from ..analysis.doubts import Doubt
from ..scene.write import doubts
from ..session import coarse_mesh
from .panel_parts import text_lines

#: Operators that cure each kind, with their icons.
CURES = {
    "coarse": (("stormfield.subdivide_mesh", "MOD_SUBSURF"), ("stormfield.solve_on_density", "MOD_REMESH")),
    "no_element": (("stormfield.fill_parts", "ADD"), ("stormfield.leave_out_parts", "HIDE_ON")),
    "faults": (("stormfield.select_faults", "RESTRICT_SELECT_OFF"),),
    "inward": (("stormfield.fix_normals", "NORMALS_FACE"),),
}


#: What the folded line of each kind says.
TITLES = {
    "coarse": "Mesh Too Coarse",
    "no_element": "Parts Have No Element",
    "faults": "Mesh Is Solved Around Faults",
    "inward": "Faces Point Inward",
}


def draw(context: bpy.types.Context, layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    found = doubts.read(obj)
    coarse = "" if any(doubt.kind == "coarse" for doubt in found) else coarse_mesh.why_too_coarse(obj)
    if coarse:  # what can be said before a solve
        found.append(Doubt("coarse", coarse))
    for doubt in found:
        header, body = layout.panel(f"stormfield_doubt_{doubt.kind}", default_closed=True)
        header.label(text=TITLES[doubt.kind], icon="ERROR")
        if body is not None:
            text_lines(context, body, doubt.text, icon="BLANK1")
        row = layout.row(align=True)
        for operator, icon in CURES[doubt.kind]:
            row.operator(operator, icon=icon)
