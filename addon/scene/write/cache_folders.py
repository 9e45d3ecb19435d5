# SPDX-License-Identifier: GPL-3.0-or-later
"""Cache folders of the open file: moved next to it when it is first saved, deleted when newer ones have come.

A cache that moves is copied, shown from its new place, and only then removed: the field is never without it.
"""

import shutil
from collections.abc import Collection
from pathlib import Path

import bpy

from ...cache.layout import MANIFEST
from ...cache.store import delete_cache
from ..read.attached import NAMES, attached_folder
from ..read.folders import cache_root, shown_folders, temporary_root

#: Caches of each sort that are kept for undo besides those in use; older ones are deleted.
KEPT = 4


def move_temporary_caches(blend: str) -> list[Path]:
    """Called just before the file `blend` is written. Returns the folders the caches have now."""
    moved: dict[Path, Path] = {}
    if not blend:
        return []
    temporary = temporary_root()
    for obj in bpy.data.objects:
        for name in NAMES:
            folder = attached_folder(obj, name)
            if folder is None or temporary not in folder.parents or not folder.is_dir():
                continue
            if folder not in moved:
                moved[folder] = _copy(folder, cache_root(obj, blend) / folder.name)
            cache_file = obj.modifiers[name].cache_file
            # Absolute while the file has no name yet; Blender writes it relative to the file.
            cache_file.filepath = str(moved[folder] / Path(cache_file.filepath).name)
    for folder in moved:
        delete_cache(folder)
    return list(moved.values())


def _copy(folder: Path, target: Path) -> Path:
    if not target.exists():
        half = target.with_name(target.name + ".tmp-copy")
        half.parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(half, ignore_errors=True)
        shutil.copytree(folder, half)
        half.rename(target)
    return target


def delete_old_caches(root: Path, sort: str, keep: Collection[Path] = ()) -> list[Path]:
    """Delete all but the newest finished caches of a sort ("lambda", "frames"), those that the open file shows, and
    those to `keep`."""
    shown = shown_folders().union(keep)
    finished = [manifest for manifest in root.glob(f"{sort}-*/{MANIFEST}") if manifest.parent not in shown]
    finished.sort(key=lambda manifest: manifest.stat().st_mtime, reverse=True)
    old = [manifest.parent for manifest in finished[KEPT:]]
    for folder in old:
        delete_cache(folder)
    return old
