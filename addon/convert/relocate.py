"""Caches made before the file had a name move beside it when it is saved for the first time.

They are copied, shown from their new place, and only then removed: at no moment is the field without its cache.
"""

import shutil
from pathlib import Path

import bpy

from ..bake.store import delete_cache
from .attach import NAMES, attached_folder
from .folders import cache_root, temporary_root


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
