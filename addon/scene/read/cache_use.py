# SPDX-License-Identifier: GPL-3.0-or-later
"""Which caches around the open file are used, and by what: the .blend files beside, below and next to their folder, the
autosaves, and the files elsewhere that have written themselves down in it."""

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...cache.blend_files import blend_files, caches_named
from ...cache.layout import FOLDER_NAME, MANIFEST, OLD_FOLDERS, PLAN
from .cache_paths import fields, shown_folders
from .folders import base_folder, file_base

#: The file, in a base folder, that names .blend files elsewhere that use it.
USERS = "used_by.txt"
#: Where .blend files are looked for: levels below the base's parent and below that one's parent, and folders at most.
DEPTH_BELOW, DEPTH_BESIDE, FOLDERS = 8, 2, 4000
#: A cache that was written so lately (seconds) may be shown by another Blender that has not saved yet.
RECENT = 3600.0


@dataclass(frozen=True)
class CacheUse:
    folder: Path
    size: int  #: bytes
    written: float  #: seconds since the epoch
    why_kept: str  #: empty where no file in reach names it


@dataclass(frozen=True)
class _Reach:
    """What the .blend files around a base folder name."""

    named: dict[str, str]  #: by name of a cache: a file that names it
    doubt: str  #: why other caches may be used nevertheless


def cache_uses() -> list[CacheUse]:
    """Every cache in the base folders of the open file, with its use. Reads all .blend files in reach."""
    shown = shown_folders()
    bases = {base_folder(obj) for obj in fields()} | {file_base(bpy.data.filepath)}
    return [use for base in sorted(bases) if base.is_dir() for use in _uses(base, shown)]


def write_user(base: Path, blend: Path) -> None:
    """Let a base folder know of a file that a search around it would not find. Where that cannot be written nothing can
    be deleted."""
    if base.is_dir() and not _is_in_reach(base, blend) and blend not in _users(base):
        with contextlib.suppress(OSError), (base / USERS).open("a", encoding="utf-8", newline="\n") as file:
            file.write(f"{blend}\n")


def _uses(base: Path, shown: set[Path]) -> Iterator[CacheUse]:
    reach = _reach(base)
    for folder in sorted(base.glob("*/*")):
        if not _is_cache(folder):
            continue
        if folder in shown:
            why = "shown in this file"
        elif folder.name in reach.named:
            why = f"named by {reach.named[folder.name]}"
        else:
            why = reach.doubt
        files = [path.stat() for path in folder.rglob("*") if path.is_file()]
        written = max((file.st_mtime for file in files), default=0.0)
        yield CacheUse(folder, sum(file.st_size for file in files), written, why)


def is_recent(use: CacheUse) -> bool:
    return time.time() - use.written < RECENT


def _is_cache(folder: Path) -> bool:
    known = FOLDER_NAME.fullmatch(folder.name.encode(errors="replace")) or folder.name in OLD_FOLDERS
    return bool(known) and any((folder / name).is_file() for name in (MANIFEST, PLAN))


def _reach(base: Path) -> _Reach:
    below, all_below = blend_files(base.parent, DEPTH_BELOW, FOLDERS)
    beside, all_beside = blend_files(base.parent.parent, DEPTH_BESIDE, FOLDERS)
    autosaves, _ = blend_files(Path(bpy.app.tempdir).parent, 0, 1)
    users = _users(base)
    doubt = "" if all_below and all_beside else "too many folders around it to look for files that name it"
    named: dict[str, str] = {}
    for blend in sorted({*below, *beside, *autosaves, *users}):
        names = caches_named(blend)
        if names is None:
            doubt = f"{blend.name} may need it, but {'cannot be read' if blend.exists() else 'is gone'}"
            continue
        for name in names:
            named.setdefault(name, blend.name)
    return _Reach(named, doubt)


def _is_in_reach(base: Path, blend: Path) -> bool:
    """Whether _reach looks into the folder of a file."""
    around = ((base.parent, DEPTH_BELOW), (base.parent.parent, DEPTH_BESIDE))
    return any(
        blend.is_relative_to(folder) and len(blend.parent.relative_to(folder).parts) <= depth
        for folder, depth in around
    )


def _users(base: Path) -> list[Path]:
    try:
        return [Path(line) for line in (base / USERS).read_text(encoding="utf-8").splitlines() if line]
    except OSError:
        return []
