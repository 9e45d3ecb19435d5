# SPDX-License-Identifier: GPL-3.0-or-later
"""NetCDF → Dataset. netCDF4 reads it where it is installed. Blender does not have it: there the extension brings pyfive
and h5netcdf, which read HDF5 in Python (hdf5.py), and the classic formats are read by classic.py. All give the same.

Values are decoded as xarray decodes them, by _FillValue, missing_value, scale_factor, add_offset and _Unsigned; times
are numbers.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import InputError, MissingPackageError
from .classic import is_classic, open_classic
from .dataset import Dataset, Index, Variable
from .hdf5 import open_hdf5
from .stored import Stored, StoredFile

#: Attributes that say how values are stored.
PACKING = ("_FillValue", "missing_value", "scale_factor", "add_offset", "_Unsigned")
#: The same, and those that say which variables belong to one.
ENCODING = (*PACKING, "coordinates")


@contextmanager
def netcdf(path: Path) -> Iterator[Dataset]:
    """The variables of a NetCDF file while it is open. Raises OSError or ValueError where it is none, and
    MissingPackageError where a package for its format is missing."""
    with _opened(path) as file:
        variables = {one.name: _variable(_careful(path, one)) for one in file.variables}
        named = {word for one in variables.values() for word in str(one.encoding.get("coordinates", "")).split()}
        axes = {name for name, one in variables.items() if one.dims == (name,)}
        yield Dataset(variables, (named & variables.keys()) | axes, file.groups)


def _opened(path: Path):
    if _has("netCDF4"):
        return _open_netcdf4(path)
    if is_classic(path):
        return open_classic(path)
    if _has("h5netcdf") and _has("pyfive"):
        return open_hdf5(path)
    raise MissingPackageError(
        f"{path}: reading it needs the Python package netCDF4; install it with: pip install netCDF4", "netCDF4"
    )


def _has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


@contextmanager
def _open_netcdf4(path: Path) -> Iterator[StoredFile]:
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        yield StoredFile(tuple(_of_netcdf4(*item) for item in file.variables.items()), tuple(file.groups))


def _of_netcdf4(name: str, variable) -> Stored:
    attrs = {key: variable.getncattr(key) for key in variable.ncattrs()}
    dtype = np.dtype(object if variable.dtype is str else variable.dtype).newbyteorder("=")

    def read(index: Index) -> np.ndarray:
        return np.asarray(variable[index] if index else variable[...], dtype)

    return Stored(name, tuple(variable.dimensions), tuple(variable.shape), dtype, attrs, read)


def _careful(path: Path, stored: Stored) -> Stored:
    """The same, which names file and variable where its values are damaged."""

    def read(index: Index) -> np.ndarray:
        try:
            return stored.read(index)
        except InputError:
            raise
        except Exception as fault:
            raise InputError(
                f"{path}: the values of {stored.name} cannot be read ({fault}); check the file, and write it anew"
            ) from fault

    return replace(stored, read=read)


def _variable(stored: Stored) -> Variable:
    attrs = dict(stored.attrs)
    encoding = {key: attrs.pop(key) for key in ENCODING if key in attrs}
    encoding["dtype"] = stored.dtype
    if not encoding.keys() & set(PACKING) or not np.issubdtype(stored.dtype, np.number):
        return Variable(stored.name, stored.dims, stored.shape, stored.dtype, stored.read, attrs, encoding)

    def load(index: Index) -> np.ndarray:
        return _decoded(stored.read(index), encoding)

    return Variable(stored.name, stored.dims, stored.shape, np.dtype(np.float64), load, attrs, encoding)


def _decoded(values: np.ndarray, encoding: Mapping[str, Any]) -> np.ndarray:
    marks = [np.ravel(encoding[key]) for key in ("_FillValue", "missing_value") if key in encoding]
    if str(encoding.get("_Unsigned", "")).lower() == "true" and values.dtype.kind == "i":
        unsigned = np.dtype(f"u{values.dtype.itemsize}")
        values, marks = values.view(unsigned), [mark.astype(values.dtype).view(unsigned) for mark in marks]
    missing = np.isin(values, np.concatenate(marks)) if marks else np.zeros(values.shape, bool)
    scaled = values.astype(np.float64) * float(encoding.get("scale_factor", 1.0)) + float(
        encoding.get("add_offset", 0.0)
    )
    return np.where(missing, np.nan, scaled)
