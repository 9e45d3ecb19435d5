# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: each reads the context, calls plain functions and reports in plain words."""

import bpy

from ..session import running
from . import (
    analyze,
    analyze_lambda,
    bake,
    baked_caches,
    caches,
    doubts,
    draw,
    edit_list,
    edit_move,
    edit_region,
    edits,
    elements,
    faults,
    field,
    given_field,
    import_data,
    job_operator,
    morse,
    pathlines,
    presets,
    select_entity,
    shading,
    solve,
    storm_merge,
    streamlines,
    transfer,
)

CLASSES = (
    *field.CLASSES,
    *given_field.CLASSES,
    *import_data.CLASSES,
    *elements.CLASSES,
    *draw.CLASSES,
    *job_operator.CLASSES,
    *solve.CLASSES,
    *doubts.CLASSES,
    *faults.CLASSES,
    *transfer.CLASSES,
    *bake.CLASSES,
    *baked_caches.CLASSES,
    *caches.CLASSES,
    *analyze.CLASSES,
    *analyze_lambda.CLASSES,
    *edits.CLASSES,
    *edit_region.CLASSES,
    *edit_move.CLASSES,
    *edit_list.CLASSES,
    *morse.CLASSES,
    *select_entity.CLASSES,
    *streamlines.CLASSES,
    *pathlines.CLASSES,
    *presets.CLASSES,
    *shading.CLASSES,
    *storm_merge.CLASSES,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    presets.register_folder()


def unregister() -> None:
    running.request_cancel()
    presets.unregister_folder()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
