# SPDX-License-Identifier: GPL-3.0-or-later
"""Which caches a .blend file names, without opening it in Blender: their names are unique, so their bytes are found."""

import gzip
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .layout import FOLDER_NAME, OLD_FOLDERS

#: Bytes that are searched at once, and those searched again because a name may lie across two parts.
PART, OVERLAP = 8 << 20, 64
#: What Blender writes last; a file without it is still being written, or was cut off.
LAST_BLOCK = b"ENDB"
GZIP, ZSTANDARD = b"\x1f\x8b", b"\x28\xb5\x2f\xfd"


def caches_named(blend: Path) -> frozenset[str] | None:
    """Names of the cache folders that a file names anywhere; None where the file cannot be read."""
    names: set[str] = set()
    tail = b""
    try:
        with blend.open("rb") as file:
            for part in _parts(file):
                text = tail + part
                names.update(found.group().decode() for found in FOLDER_NAME.finditer(text))
                names.update(old for old in OLD_FOLDERS if f"/{old}/".encode() in text)
                tail = text[-OVERLAP:]
    except (OSError, EOFError, zlib.error, ImportError, ValueError):
        return None
    return frozenset(names) if LAST_BLOCK in tail else None


def blend_files(folder: Path, depth: int, limit: int) -> tuple[list[Path], bool]:
    """The .blend files, and their numbered backups, in a folder and those `depth` levels below; and whether all of them
    were looked at: not more than `limit` folders are."""
    found: list[Path] = []
    for visited, (parent, folders, files) in enumerate(os.walk(folder)):
        if visited == limit:
            return found, False
        if len(Path(parent).relative_to(folder).parts) >= depth:
            folders.clear()
        folders[:] = [name for name in folders if not FOLDER_NAME.fullmatch(name.encode(errors="replace"))]
        found += [Path(parent, name) for name in files if _is_blend(name)]
    return found, True


def _is_blend(name: str) -> bool:
    """shot.blend, and shot.blend1 as Blender keeps it beside."""
    return name.rstrip("0123456789").lower().endswith(".blend")


def _parts(file: BinaryIO) -> Iterator[bytes]:
    """The content of a file as Blender writes it: plain, by Zstandard, or by gzip before 3.0."""
    start = file.read(4)
    file.seek(0)
    if start == ZSTANDARD:
        yield from _decompressed(file)
    elif start.startswith(GZIP):
        with gzip.open(file) as content:
            yield from iter(lambda: content.read(PART), b"")
    else:
        yield from iter(lambda: file.read(PART), b"")


def _decompressed(file: BinaryIO) -> Iterator[bytes]:
    try:
        from compression import zstd  # Python 3.14
    except ImportError:
        yield from _decompressed_by_zstandard(file)
        return
    try:
        with zstd.open(file) as content:
            yield from iter(lambda: content.read(PART), b"")
    except zstd.ZstdError as error:
        raise ValueError(f"damaged: {error}") from error


def _decompressed_by_zstandard(file: BinaryIO) -> Iterator[bytes]:
    import zstandard  # Blender brings it

    try:
        with zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True) as content:
            yield from iter(lambda: content.read(PART), b"")
    except zstandard.ZstdError as error:
        raise ValueError(f"damaged: {error}") from error
