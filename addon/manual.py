# SPDX-License-Identifier: GPL-3.0-or-later
"""F1, and right-click → Online Manual: the page of the documentation for each operator and setting of ours.

Places on a page follow from the name, as docs/extension/stormfield_docs/addon.py makes them.
tests/blender/test_manual.py checks that every one exists.
"""

from functools import cache

import bpy

from . import properties

#: Where the documentation is read. The project has no address of its own yet: this is the only place that names one.
SITE = "https://stormfield.readthedocs.io/en/latest/"

#: Page of each operator, by the last part of its name.
OPERATORS = {
    "panels/field": (
        *("add_field", "remove_field", "key_lambda", "cancel_job", "storm_merge"),
        *("field_from_attribute", "import_data"),
    ),
    "panels/elements": (
        *("draw_element", "finish_drawing", "add_elements", "place_element", "place_bifurcation"),
        *("remove_element", "move_element", "element_preset", "select_element"),
    ),
    "panels/solve": (
        *("solve", "add_preset", "select_faults", "transfer_field"),
        *("subdivide_mesh", "solve_on_density", "fix_normals", "fill_parts", "leave_out_parts"),
    ),
    "panels/bake": ("bake", "use_baked_caches", "bring_caches", "clean_caches"),
    "panels/shading": ("apply_material", "material_from_image"),
    "panels/analysis": (
        *("analyze", "analyze_lambda", "go_to_entity", "show_graph", "update_markers"),
        *("forget_analysis", "select_entity"),
    ),
    "panels/edits": (
        *("cancel_pair", "cancel_weakest", "simplify", "move_point", "smooth_region", "transform_field"),
        *("apply_edits", "remove_edit", "move_edit"),
    ),
    "panels/graph": ("keep_entity",),
    "panels/curves": ("streamlines", "pathlines"),
    "panels/morse": ("morse_sets", "refine_morse", "refine_set"),
}
#: Page of each property group's settings.
SETTINGS = {
    "FieldProperties": "panels/field",
    "ElementProperties": "panels/elements",
    "SolveProperties": "panels/solve",
    "EditProperties": "panels/edits",
    "BakeProperties": "panels/bake",
    "LookProperties": "panels/look",
    "AnalysisProperties": "panels/look",
    "EntityItem": "panels/analysis",
    "EntityList": "panels/analysis",
    "MorseProperties": "panels/morse",
}
#: Settings that another page than their group's explains.
ELSEWHERE = {
    ("AnalysisProperties", "shown"): "panels/analysis",
    ("AnalysisProperties", "persistence"): "panels/analysis",
    ("AnalysisProperties", "detail"): "panels/analysis",
    ("AnalysisProperties", "show_partners"): "panels/edits",
    ("AnalysisProperties", "preview_simplify"): "panels/edits",
    ("AnalysisProperties", "keep"): "panels/edits",
}


@cache
def entries() -> tuple[tuple[str, str], ...]:
    """(name in Blender's Python, in lower case as Blender asks; place relative to SITE); the first that fits counts."""
    found = []
    for page, names in OPERATORS.items():
        for name in names:
            place = f"{page}.html#operator-{name.replace('_', '-')}"
            found += [(f"bpy.ops.stormfield.{name}", place), (f"bpy.types.stormfield_ot_{name}.*", place)]
    for group in properties.CLASSES:
        name = group.__name__
        for setting in group.__annotations__:
            page = ELSEWHERE.get((name, setting), SETTINGS[name])
            anchor = f"{name}-{setting}".lower().replace("_", "-")
            found.append((f"bpy.types.{name}.{setting}".lower(), f"{page}.html#{anchor}"))
    return (*found, ("bpy.types.stormfield_mt_*", "panels/elements.html"))


def _entries() -> tuple[str, tuple[tuple[str, str], ...]]:
    return SITE, entries()


def register() -> None:
    bpy.utils.register_manual_map(_entries)


def unregister() -> None:
    bpy.utils.unregister_manual_map(_entries)
