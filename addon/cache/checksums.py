# SPDX-License-Identifier: GPL-3.0-or-later
"""SHA-256 of files. Of large ones it is remembered for their present version, so that what this process has written or
read already is not read again."""

import hashlib
from pathlib import Path

#: Files that are remembered; when there are more, all are forgotten.
MOST = 256

_known: dict[Path, tuple[tuple[int, ...], str]] = {}


def sha256(path: Path) -> str:
    """Reads the file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def known_sha256(path: Path) -> str:
    """Reads the file only where this version of it is not known. Raises FileNotFoundError."""
    version = _version(path)
    if path not in _known or _known[path][0] != version:
        digest = sha256(path)
        if _version(path) != version:  # it was replaced meanwhile
            return digest
        remember(path, digest)
    return _known[path][1]


def remember(path: Path, digest: str) -> None:
    """What the file has now."""
    if len(_known) >= MOST:
        _known.clear()
    _known[path] = _version(path), digest


def _version(path: Path) -> tuple[int, ...]:
    """Changes when the file does."""
    status = path.stat()
    return status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns
