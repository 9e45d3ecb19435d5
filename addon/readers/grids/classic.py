# SPDX-License-Identifier: GPL-3.0-or-later
"""The classic formats of NetCDF: the original (CDF-1), with 64-bit offsets (CDF-2) and with 64-bit data (CDF-5).

A file is a header and, for each variable, its numbers in big-endian order. Variables on the unlimited dimension lie in
records: one entry of each variable after another. The Unidata netCDF-C manual, "The NetCDF Classic Format
Specification", has the grammar whose names are used here.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .dataset import Index
from .stored import Stored, StoredFile

TYPES = {1: "i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8", 7: "u1", 8: ">u2", 9: ">u4", 10: ">i8", 11: ">u8"}
DIMENSIONS, VARIABLES, ATTRIBUTES = 10, 11, 12
CHARACTERS = 2
#: Version → formats of counts and of offsets.
VERSIONS = {1: (">i", ">i"), 2: (">i", ">q"), 5: (">q", ">q")}
#: The number of records where it was not known when the header was written.
STREAMING = -1


def is_classic(path: Path) -> bool:
    """By its first bytes."""
    with path.open("rb") as file:
        return file.read(4) in {b"CDF" + bytes([version]) for version in VERSIONS}


@contextmanager
def open_classic(path: Path) -> Iterator[StoredFile]:
    """The variables; values are read when asked for. Raises ValueError where the file is cut off or damaged."""
    try:
        header = _Header(path)
    except (struct.error, IndexError, KeyError, MemoryError) as fault:
        raise ValueError("its header is damaged or cut off") from fault
    yield StoredFile(tuple(_stored(path, header, variable) for variable in header.variables))


@dataclass(frozen=True)
class _Declared:
    """begin: where the values start; bytes of one entry, all of them or those of one record."""

    name: str
    dims: tuple[int, ...]
    attrs: dict[str, Any]
    dtype: np.dtype
    begin: int


class _Header:
    """dims: name and length of each, None of the unlimited; records: its length, record_bytes: from one to the next."""

    def __init__(self, path: Path) -> None:
        with path.open("rb") as self._file:
            self._count, self._offset = VERSIONS[self._file.read(4)[3]]
            records = self._number(self._count)
            self.dims = [(self._name(), self._number(self._count) or None) for _ in self._list(DIMENSIONS)]
            self._attributes()  # of the file
            self.variables = [self._variable() for _ in self._list(VARIABLES)]
        along = [one for one in self.variables if self.is_record(one)]
        # A record of one variable alone is not padded.
        sizes = [self.entry_bytes(one) for one in along]
        self.record_bytes = sizes[0] if len(sizes) == 1 else sum(map(_padded, sizes))
        self.records = records
        if records == STREAMING:
            behind = path.stat().st_size - min((one.begin for one in along), default=0)
            self.records = behind // self.record_bytes if self.record_bytes else 0

    def is_record(self, variable: _Declared) -> bool:
        return bool(variable.dims) and self.dims[variable.dims[0]][1] is None

    def shape(self, variable: _Declared) -> tuple[int, ...]:
        return tuple(self.records if size is None else size for _, size in (self.dims[k] for k in variable.dims))

    def entry_bytes(self, variable: _Declared) -> int:
        """Bytes of all values, or of those in one record."""
        sizes = [size for _, size in (self.dims[k] for k in variable.dims) if size is not None]
        return math.prod(sizes) * variable.dtype.itemsize

    def _number(self, kind: str) -> int:
        return struct.unpack(kind, self._file.read(struct.calcsize(kind)))[0]

    def _name(self) -> str:
        return self._padded_bytes(self._number(self._count)).decode()

    def _padded_bytes(self, size: int) -> bytes:
        found = self._file.read(_padded(size))
        if len(found) < size:
            raise IndexError(size)
        return found[:size]

    def _list(self, expected: int) -> range:
        """As many as the list has that begins here; an absent one has the tag zero."""
        tag, size = self._number(">i"), self._number(self._count)
        if size and tag != expected:
            raise KeyError(tag)
        return range(size)

    def _attributes(self) -> dict[str, Any]:
        return dict((self._name(), self._values()) for _ in self._list(ATTRIBUTES))

    def _values(self) -> Any:
        kind, size = self._number(">i"), self._number(self._count)
        dtype = np.dtype(TYPES[kind])
        found = self._padded_bytes(size * dtype.itemsize)
        if kind == CHARACTERS:
            return found.decode(errors="replace").rstrip("\0")
        values = np.frombuffer(found, dtype).astype(dtype.newbyteorder("="))
        return values[0] if size == 1 else values

    def _variable(self) -> _Declared:
        name = self._name()
        dims = tuple(self._number(self._count) for _ in range(self._number(self._count)))
        attrs, kind = self._attributes(), self._number(">i")
        self._number(self._count)  # its size, which large variables do not fit into
        return _Declared(name, dims, attrs, np.dtype(TYPES[kind]), self._number(self._offset))


def _stored(path: Path, header: _Header, variable: _Declared) -> Stored:
    shape = header.shape(variable)
    names = tuple(header.dims[k][0] for k in variable.dims)
    native = variable.dtype.newbyteorder("=")

    def read(index: Index) -> np.ndarray:
        if not math.prod(shape):
            return np.empty(shape, native)[index]
        return np.asarray(_mapped(path, header, variable, shape)[index], native)

    return Stored(variable.name, names, shape, native, variable.attrs, read)


def _mapped(path: Path, header: _Header, variable: _Declared, shape: tuple[int, ...]) -> np.ndarray:
    """The values as they lie in the file."""
    size, records = header.entry_bytes(variable), header.is_record(variable)
    length = (shape[0] - 1) * header.record_bytes + size if records else size
    if variable.begin + length > path.stat().st_size:
        raise ValueError(f"the file is cut off: the values of {variable.name} end behind its end")
    whole = np.memmap(path, np.uint8, "r", variable.begin, length)
    if not records:
        return whole.view(variable.dtype).reshape(shape)
    strides = np.empty(shape[1:], variable.dtype).strides
    return np.ndarray(shape, variable.dtype, whole, strides=(header.record_bytes, *strides))


def _padded(size: int) -> int:
    """The next multiple of four."""
    return -(-size // 4) * 4
