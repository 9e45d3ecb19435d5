# SPDX-License-Identifier: GPL-3.0-or-later
"""A cache in a second place: whole or, as long as it lacks its manifest, not there at all.

Files of a cache never change once they have their name (cache/store.py writes others and renames them), so both places
share their bytes where the file system can link files; else they are copied.
"""

import os
import shutil
import socket
from pathlib import Path

from .layout import MANIFEST
from .store import TEMPORARY, disk_faults, rename


def copy_cache(folder: Path, target: Path) -> None:
    """Makes `target` the same cache as `folder`; what is there already stays. Raises InputError for faults of the
    disk."""
    with disk_faults(target):
        for path in _files(folder):
            goal = target / path.relative_to(folder)
            if not goal.exists():
                goal.parent.mkdir(parents=True, exist_ok=True)
                _place(path, goal)


def _files(folder: Path) -> list[Path]:
    """All files of a cache, the manifest last."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and not path.name.startswith(TEMPORARY)]
    return sorted(files, key=lambda path: path == folder / MANIFEST)


def _place(path: Path, goal: Path) -> None:
    temporary = goal.with_name(f"{TEMPORARY}{socket.gethostname()}-{os.getpid()}-{goal.name}")
    temporary.unlink(missing_ok=True)
    try:
        try:
            os.link(path, temporary)
        except OSError:  # another disk, or a file system without links
            shutil.copy2(path, temporary)
        rename(temporary, goal)
    finally:
        temporary.unlink(missing_ok=True)
