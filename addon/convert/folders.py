"""Where caches live: beside the .blend file when it is saved, in Blender's temporary folder until then."""

import re
from collections.abc import Collection
from pathlib import Path

import bpy

from ..bake.store import delete_cache

NAME = "stormfield_cache"
#: Caches of each sort that are kept for undo besides those in use; older ones are deleted.
KEPT = 4


def cache_root(obj: bpy.types.Object, blend: str | None = None) -> Path:
    """The folder of all caches of `obj`, for the open file or for the file name `blend`."""
    chosen = obj.stormfield.bake.folder
    blend = bpy.data.filepath if blend is None else blend
    if chosen and not (chosen.startswith("//") and not blend):
        base = Path(bpy.path.abspath(chosen, start=str(Path(blend).parent) if blend else None))
    elif blend:
        base = Path(blend).parent / NAME
    else:
        base = temporary_root()
    return base / file_name(obj.name)


def temporary_root() -> Path:
    return Path(bpy.app.tempdir) / NAME


def file_name(name: str) -> str:
    """An object's name as a folder's name on every system: any letters, without what paths forbid."""
    cleaned = re.sub(r'[\\/:*?"<>|\x00-\x1f]', "_", name).strip(" .")
    return cleaned or "object"


def shown_folders() -> set[Path]:
    """Folders of the caches that the open file shows."""
    return {Path(bpy.path.abspath(cache_file.filepath)).parent for cache_file in bpy.data.cache_files}


def delete_old_caches(root: Path, sort: str, keep: Collection[Path] = ()) -> list[Path]:
    """Delete all but the newest finished caches of a sort ("lambda", "frames"), those that the open file shows, and
    those to `keep`."""
    shown = shown_folders().union(keep)
    finished = [manifest for manifest in root.glob(f"{sort}-*/manifest.json") if manifest.parent not in shown]
    finished.sort(key=lambda manifest: manifest.stat().st_mtime, reverse=True)
    old = [manifest.parent for manifest in finished[KEPT:]]
    for folder in old:
        delete_cache(folder)
    return old
