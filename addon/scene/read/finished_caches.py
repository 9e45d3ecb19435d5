# SPDX-License-Identifier: GPL-3.0-or-later
"""Which finished caches belong to what the scene says now, and which of them it does not show yet."""

from dataclasses import replace
from pathlib import Path

import bpy

from ...bake.finished import Finished, finished
from ...bake.targets import TARGETS
from ...cache.layout import MANIFEST
from .attached import FRAMES, LAMBDA, MORSE, attached_folder
from .bake_task import read_bake_task
from .design import read_design
from .folders import cache_root

#: Caches that the mesh shows, by the modifier that shows them, and what artists call them.
WORDS = {LAMBDA: "field", FRAMES: "flowing texture", MORSE: "Morse sets"}


def read_finished(context: bpy.types.Context, obj: bpy.types.Object) -> Finished:
    """Raises InputError where the design cannot be read."""
    _mesh, design = read_design(context, obj)
    task = replace(read_bake_task(context, obj, Path()), targets=frozenset(TARGETS))
    return finished(task, design)


def are_any(obj: bpy.types.Object) -> bool:
    """Whether the object has finished caches at all that it does not show. Quick."""
    shown = {attached_folder(obj, name) for name in WORDS}
    return any(manifest.parent not in shown for manifest in cache_root(obj).glob(f"*/{MANIFEST}"))


def not_shown(obj: bpy.types.Object, found: Finished) -> list[str]:
    """Words for those that the object does not show, in the order of WORDS."""
    places = {LAMBDA: found.solved, FRAMES: found.targets.get("usd"), MORSE: found.targets.get("morse")}
    return [
        word
        for name, word in WORDS.items()
        if (place := places[name]) is not None and place != attached_folder(obj, name)
    ]
