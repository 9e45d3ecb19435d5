# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches go where their file goes: beside it when it is first saved, recovered or saved elsewhere.

A cache that moves is copied (cache/copying.py) and shown from its new place; the old one stays, for undo and for files
that name it. What cannot be copied keeps its place, or one that outlives this session, and is tried again at the next
save.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import bpy

from ...cache.copying import copy_cache
from ...cache.layout import PLAN
from ...model.errors import InputError
from ..read.attached import attached_folders
from ..read.cache_paths import CachePath, cache_paths, fields
from ..read.cache_use import write_user
from ..read.folders import NAME, base_folder, file_base, relative, temporary_root


@dataclass
class Saving:
    """What saving a file did to the caches it names."""

    refused: list[str] = field(default_factory=list)  #: sentences for the artist
    _before: list[tuple[CachePath, str]] = field(default_factory=list)

    def change(self, path: CachePath, text: str) -> None:
        self._before.append((path, path.text))
        path.write(text)

    def undo(self) -> None:
        """Every path as it was: where a copy of the file was saved, the open file keeps its own."""
        for path, text in reversed(self._before):
            path.write(text)


def bring_along(blend: str) -> Saving:
    """Called just before the file `blend` is written: every cache it names is where the file will look for it."""
    saving = Saving()
    bases = _bases(blend)
    moved: dict[Path, Path] = {}
    paths = list(cache_paths())
    for folder in [*dict.fromkeys(path.folder for path in paths), *_unfinished()]:
        old, new = bases.get(folder, (file_base(bpy.data.filepath), file_base(blend)))
        if folder.is_dir() and _comes_along(folder, old, new):
            moved[folder] = _brought(folder, new / folder.parent.name / folder.name, saving)
    for path in paths:
        place = path.inside(moved.get(path.folder, path.folder))
        if path.is_record:
            saving.change(path, relative(place, blend))
        elif path.folder in moved:
            # Blender rewrites relative paths for the new file itself, and all paths at the first save.
            saving.change(path, relative(place, bpy.data.filepath))
        write_user(moved.get(path.folder, path.folder).parent.parent, Path(blend))
    return saving


def find_moved() -> None:
    """Show caches that lie beside the open file although their path leads elsewhere: the folder was moved."""
    bases = _bases(bpy.data.filepath)
    for path in cache_paths():
        if not path.folder.exists():
            _old, base = bases.get(path.folder, (None, file_base(bpy.data.filepath)))
            beside = base / path.folder.parent.name / path.folder.name
            if beside.is_dir():
                path.write(relative(path.inside(beside), bpy.data.filepath))


def stray_folders(obj: bpy.types.Object) -> list[Path]:
    """Caches that a saved object shows from a place where no file is: they could not be copied when it was saved."""
    if not bpy.data.filepath:
        return []
    base = base_folder(obj)
    shown = set(attached_folders(obj))
    return sorted(folder for folder in shown if folder.parent.parent != base and _is_lonely(folder.parent.parent))


def kept_root() -> Path:
    """Where caches outlive the session that could not bring them to their file."""
    return Path(bpy.utils.user_resource("DATAFILES", path="stormfield")) / "unsaved" / NAME


# Steps ----------------------------------------------------------------------------------------------------------------


def _bases(blend: str) -> dict[Path, tuple[Path, Path]]:
    """The base folders of each cache's object, for the open file and for `blend`; of caches that objects know."""
    bases = {}
    for obj in fields():
        both = base_folder(obj), base_folder(obj, blend)
        bases.update(dict.fromkeys(attached_folders(obj), both))
        bases.update({path.folder: both for path in cache_paths() if path.block == obj})
    return bases


def _unfinished() -> Iterator[Path]:
    """Bakes that were stopped before the file had a name: they go on beside it."""
    for plan in temporary_root().glob(f"*/*/{PLAN}"):
        yield plan.parent


def _comes_along(folder: Path, old: Path, new: Path) -> bool:
    base = folder.parent.parent
    return base != new and (base == old or base == temporary_root() or _is_lonely(base))


def _is_lonely(base: Path) -> bool:
    """Whether a base folder lies beside no file: it is the temporary one of this or of an earlier session."""
    try:
        return base.name == NAME and not any(base.parent.glob("*.blend"))
    except OSError:
        return False


def _brought(folder: Path, target: Path, saving: Saving) -> Path:
    """The cache at its new place; where that fails, at one that outlives the session."""
    try:
        copy_cache(folder, target)
        return target
    except InputError as fault:
        kept = _kept(folder)
        saving.refused.append(f"{folder.name} could not be copied beside the file ({fault}); it is kept in {kept}")
        return kept


def _kept(folder: Path) -> Path:
    if temporary_root() not in folder.parents:
        return folder
    kept = kept_root() / folder.parent.name / folder.name
    try:
        copy_cache(folder, kept)
        return kept
    except InputError:
        return folder
