# SPDX-License-Identifier: GPL-3.0-or-later
"""Where caches live: next to the .blend file when it is saved, in Blender's temporary folder until then."""

import hashlib
import re
from pathlib import Path

import bpy

from . import user_preferences

NAME = "stormfield_cache"


def cache_root(obj: bpy.types.Object, blend: str | None = None) -> Path:
    """The folder of all caches of `obj`, for the open file or for the file name `blend`."""
    chosen, everywhere = obj.stormfield.bake.folder, user_preferences.read().cache_folder
    blend = bpy.data.filepath if blend is None else blend
    if chosen and not (chosen.startswith("//") and not blend):
        base = Path(bpy.path.abspath(chosen, start=str(Path(blend).parent) if blend else None))
    elif everywhere and blend:
        base = Path(bpy.path.abspath(everywhere)) / _file_folder(Path(blend))
    elif blend:
        base = Path(blend).parent / NAME
    else:
        base = temporary_root()
    return base / file_name(obj.name)


def _file_folder(blend: Path) -> str:
    """A folder for one .blend file among those of all files; two of the same name differ by where they lie."""
    return f"{file_name(blend.stem)}-{hashlib.sha256(str(blend.parent).encode()).hexdigest()[:8]}"


def temporary_root() -> Path:
    return Path(bpy.app.tempdir) / NAME


def file_name(name: str) -> str:
    """An object's name as a folder's name on every system: any letters, without what paths forbid."""
    cleaned = re.sub(r'[\\/:*?"<>|\x00-\x1f]', "_", name).strip(" .")
    return cleaned or "object"


def shown_folders() -> set[Path]:
    """Folders of the caches that the open file shows."""
    return {Path(bpy.path.abspath(cache_file.filepath)).parent for cache_file in bpy.data.cache_files}
