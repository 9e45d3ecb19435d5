# SPDX-License-Identifier: GPL-3.0-or-later
"""The λ caches that this session made and that no file names yet. While an artist tries a design, these alone are
deleted without being asked: a file on disk, an autosave or another object may name any other."""

from pathlib import Path

import bpy

from ..cache.blend_files import blend_files, caches_named
from ..cache.layout import MANIFEST
from ..cache.store import delete_cache
from ..scene.read.cache_paths import shown_folders

#: How many are kept for undo besides those in use.
KEPT = 4
#: How far .blend files are looked for around a cache: levels of folders, and folders at most.
DEPTH, FOLDERS = 1, 200

_made: list[Path] = []
_ever: set[str] = set()  # names, which a copy beside the file keeps


def existing(root: Path) -> frozenset[Path]:
    """The caches that are there before something is made."""
    return frozenset(root.iterdir()) if root.is_dir() else frozenset()


def note(folder: Path, before: frozenset[Path]) -> None:
    """The λ cache `folder` was made or used; `before` is what existed then."""
    note_baked(folder, before)
    if folder in _made:
        _made.remove(folder)
    elif folder in before:
        return
    _made.append(folder)


def note_baked(folder: Path, before: frozenset[Path]) -> None:
    """Any cache: it is never deleted without being asked, but known to be of this session."""
    if folder not in before:
        _ever.add(folder.name)


def is_made_here(folder: Path) -> bool:
    """Whether this session made it, so that no other can show it without having saved."""
    return folder.name in _ever


def are_saved() -> None:
    """A file names what is shown now."""
    shown = shown_folders()
    _made[:] = [folder for folder in _made if folder not in shown]


def delete_superseded() -> list[Path]:
    """Deletes all but the newest KEPT, those that the open file shows, and those that a file names; returns those."""
    shown = shown_folders()
    candidates = [folder for folder in _made if folder not in shown][:-KEPT]
    deleted = [folder for folder in candidates if not _is_named(folder)]
    for folder in deleted:
        delete_cache(folder)
    _made[:] = [folder for folder in _made if folder not in deleted]
    return deleted


def forget() -> None:
    """Caches of a file that is left stay where they are."""
    _made.clear()


def _is_named(folder: Path) -> bool:
    """Whether a .blend file around the cache, or an autosave, that is newer than it may name it."""
    try:
        born = (folder / MANIFEST).stat().st_mtime
    except FileNotFoundError:
        return True
    beside, all_seen = blend_files(folder.parents[2], DEPTH, FOLDERS)
    autosaves, _ = blend_files(Path(bpy.app.tempdir).parent, 0, 1)
    if not all_seen:
        return True
    for blend in {*beside, *autosaves}:
        try:
            newer = blend.stat().st_mtime >= born - 1.0
        except OSError:
            continue
        if newer:
            named = caches_named(blend)
            if named is None or folder.name in named:
                return True
    return False
