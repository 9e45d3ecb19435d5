# SPDX-License-Identifier: GPL-3.0-or-later
"""NetCDF 4, which is HDF5, read in Python: h5netcdf knows its dimensions and attributes, pyfive its values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import InputError
from .dataset import Index
from .stored import Stored, StoredFile

CURE = "make a λ cache of it where netCDF4 is installed, with: stormfield import FILE --out FOLDER"
#: Filters that pyfive does not read, by their registered numbers.
FILTERS = {4: "szip", 5: "nbit", 6: "scale-offset", 307: "bzip2", 32000: "LZF", 32001: "Blosc", 32004: "LZ4"}
FILTERS |= {32008: "bitshuffle", 32013: "ZFP", 32015: "Zstandard", 32017: "SZ", 32026: "Blosc 2"}


@contextmanager
def open_hdf5(path: Path) -> Iterator[StoredFile]:
    """The variables while the file is open. Raises OSError where it is no HDF5. Reading values raises
    InputError where they are compressed by what only netCDF4 reads."""
    import h5netcdf
    import pyfive

    # Types that NetCDF does not have, such as references, are no fields: they are left out, as netCDF4 leaves them out.
    settings = {"backend": "pyfive", "phony_dims": "sort", "unsupported_hdf5_features": "skip"}
    with ExitStack() as stack:
        try:
            file = stack.enter_context(h5netcdf.File(path, "r", **settings))
            values = stack.enter_context(pyfive.File(path, "r"))
            variables = tuple(_stored(path, values, *item) for item in file.variables.items())
        except (OSError, pyfive.core.InvalidHDF5File):
            raise
        except Exception as fault:
            raise InputError(f"{path}: has what only the Python package netCDF4 reads ({fault}); {CURE}") from fault
        yield StoredFile(variables, tuple(file.groups))


def _stored(path: Path, values, name: str, variable) -> Stored:
    dims, shape = tuple(variable.dimensions), tuple(variable.shape)
    dtype = np.dtype(variable.dtype).newbyteorder("=")

    def read(index: Index) -> np.ndarray:
        try:
            return _text(np.asarray(_values(values[name], shape, index), dtype))
        except (NotImplementedError, ModuleNotFoundError) as fault:
            raise InputError(
                f"{path}: the values of {name} are compressed by {_filter(fault)}, which only netCDF4 reads; "
                f"write the file anew with: nccopy -F none IN.nc OUT.nc, or {CURE}"
            ) from fault

    return Stored(name, dims, shape, dtype, _attributes(variable.attrs), read)


def _values(dataset, shape: tuple[int, ...], index: Index):
    """Values at an index; fill where a variable on an unlimited dimension, or a chunk of it, was never written."""
    chunks = _written(dataset)
    if dataset.shape == shape and chunks is None:
        return dataset[index] if index else dataset[()]
    parts = [range(size)[part] for part, size in zip(index, shape, strict=True)]
    low = [part if isinstance(part, int) else 0 for part in parts]
    high = [part + 1 if isinstance(part, int) else len(part) for part in parts]
    fill = "" if dataset.fillvalue is None else dataset.fillvalue
    block = np.full(np.subtract(high, low), fill, dataset.dtype)
    for start in chunks if chunks is not None else [(0,) * len(shape)]:
        extent = dataset.chunks if chunks is not None else dataset.shape
        first = np.maximum(start, low)
        last = np.minimum.reduce([np.add(start, extent), dataset.shape, high])
        if (first < last).all():
            block[_box(first - low, last - low)] = dataset[_box(first, last)]
    return block[tuple(0 if isinstance(part, int) else slice(None) for part in parts)]


def _box(first, last) -> tuple[slice, ...]:
    return tuple(slice(int(a), int(b)) for a, b in zip(first, last, strict=True))


def _written(dataset) -> list[tuple[int, ...]] | None:
    """Where the chunks begin that were written, or None where that is all of them."""
    if dataset.chunks is None:
        return None
    count = dataset.id.get_num_chunks()
    if count == math.prod(-(-size // chunk) for size, chunk in zip(dataset.shape, dataset.chunks, strict=True)):
        return None
    return [dataset.id.get_chunk_info(k).chunk_offset for k in range(count)]


def _text(values: np.ndarray) -> np.ndarray:
    """Words as str."""
    if values.dtype != object:
        return values
    words = [word.decode(errors="replace") if isinstance(word, bytes) else word for word in values.ravel()]
    return np.array(words, object).reshape(values.shape)


def _attributes(attrs: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _attribute(attrs[name]) for name in attrs}


def _attribute(value: Any) -> Any:
    """h5netcdf leaves text of one character and empty text as bytes, and numbers in the byte order of the file."""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    if isinstance(value, np.ndarray | np.generic) and value.dtype.kind in "iufc":
        return value.astype(value.dtype.newbyteorder("="))
    return value


def _filter(fault: Exception) -> str:
    number = re.search(r"Filter with id: (\d+)", str(fault))
    if number is None:
        return "LZF" if "lzf" in str(fault).lower() else str(fault)
    return FILTERS.get(int(number[1]), f"the HDF5 filter {number[1]}")
