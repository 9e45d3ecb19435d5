# SPDX-License-Identifier: GPL-3.0-or-later
"""Named arrays on named dimensions, read when asked for: what is needed of xarray, for single files and without it.

    with netcdf(path) as dataset:
        dataset["u10"].isel({"time": 3}).values      # (latitude, longitude), decoded

Datasets of xarray serve as well: both have the same names for the same things. As there, values are decoded by
_FillValue, missing_value, scale_factor, add_offset and _Unsigned, which move from attrs to encoding; times are numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

Index = tuple[Any, ...]
#: Attributes that say how values are stored, or which variables belong to them.
ENCODING = ("_FillValue", "missing_value", "scale_factor", "add_offset", "_Unsigned", "coordinates")


@dataclass(frozen=True, eq=False)
class Variable:
    """load: the values at an index, one entry for each dimension. coords: variables on the same dimensions."""

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype
    load: Callable[[Index], np.ndarray]
    attrs: Mapping[str, Any] = field(default_factory=dict)
    encoding: Mapping[str, Any] = field(default_factory=dict)
    coords: Mapping[str, Variable] = field(default_factory=dict)

    @classmethod
    def of(
        cls, name: str, dims: tuple[str, ...], values: np.ndarray, attrs: Mapping[str, Any] | None = None
    ) -> Variable:
        """Values that are in memory."""
        return cls(name, dims, values.shape, values.dtype, lambda index: values[index], attrs or {})

    @property
    def ndim(self) -> int:
        return len(self.dims)

    @property
    def size(self) -> int:
        return int(np.prod(self.shape))

    @property
    def sizes(self) -> dict[str, int]:
        return dict(zip(self.dims, self.shape, strict=True))

    @property
    def values(self) -> np.ndarray:
        return np.asarray(self.load((slice(None),) * self.ndim))

    def __float__(self) -> float:
        return float(self.values)

    def __getitem__(self, index: Index | int) -> Variable:
        values = self.values[index]
        kept = [
            dim
            for dim, part in zip(self.dims, index if isinstance(index, tuple) else (index,), strict=False)
            if not isinstance(part, int)
        ]
        dims = (*kept, *self.dims[len(index) if isinstance(index, tuple) else 1 :])
        return self._with(tuple(dims), values)

    def isel(self, chosen: Mapping[str, int]) -> Variable:
        """One index of each named dimension that it has; these dimensions go."""
        chosen = {dim: index for dim, index in chosen.items() if dim in self.dims}
        if not chosen:
            return self

        def load(index: Index) -> np.ndarray:
            rest = iter(index)
            return self.load(tuple(chosen[dim] if dim in chosen else next(rest) for dim in self.dims))

        kept = [k for k, dim in enumerate(self.dims) if dim not in chosen]
        dims, shape = tuple(self.dims[k] for k in kept), tuple(self.shape[k] for k in kept)
        coords = {name: known for name, known in self.coords.items() if set(known.dims) <= set(dims)}
        return replace(self, dims=dims, shape=shape, load=load, coords=coords)

    def transpose(self, *dims: str) -> Variable:
        return self._with(dims, self.values.transpose([self.dims.index(dim) for dim in dims]))

    def astype(self, dtype: type) -> Variable:
        return self._with(self.dims, self.values.astype(dtype))

    def copy(self, data: np.ndarray) -> Variable:
        """The same with other values."""
        return self._with(self.dims, data)

    def _with(self, dims: tuple[str, ...], values: np.ndarray) -> Variable:
        return replace(self, dims=dims, shape=values.shape, dtype=values.dtype, load=lambda index: values[index])


class Dataset:
    """Variables by name; those that are coordinates beside the data."""

    def __init__(self, variables: Mapping[str, Variable], coords: set[str]) -> None:
        self.coords = {name: variable for name, variable in variables.items() if name in coords}
        self.variables = {
            name: replace(
                variable,
                coords={known: at for known, at in self.coords.items() if set(at.dims) <= set(variable.dims)},
            )
            for name, variable in variables.items()
        }
        self.data_vars = {name: one for name, one in self.variables.items() if name not in coords}
        self.sizes = {dim: size for variable in variables.values() for dim, size in variable.sizes.items()}
        self.dims = tuple(self.sizes)

    def __getitem__(self, name: str) -> Variable:
        return self.variables[name]

    def isel(self, chosen: Mapping[str, int]) -> Dataset:
        """One index of each named dimension, of every variable that has it."""
        return Dataset({name: one.isel(chosen) for name, one in self.variables.items()}, set(self.coords))


@contextmanager
def netcdf(path: Path) -> Iterator[Dataset]:
    """The variables of a NetCDF file while it is open. Raises OSError where it is none."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        variables = {name: _variable(name, stored) for name, stored in file.variables.items()}
        named = {word for one in variables.values() for word in str(one.encoding.get("coordinates", "")).split()}
        axes = {name for name, one in variables.items() if one.dims == (name,)}
        yield Dataset(variables, (named & variables.keys()) | axes)


def _variable(name: str, stored) -> Variable:
    attrs = {key: stored.getncattr(key) for key in stored.ncattrs()}
    encoding = {key: attrs.pop(key) for key in ENCODING if key in attrs}
    encoding["dtype"] = dtype = np.dtype(stored.dtype)
    plain = not encoding.keys() & set(ENCODING[:5])

    def load(index: Index) -> np.ndarray:
        values = np.asarray(stored[index] if index else stored[...])
        return values if plain or not np.issubdtype(dtype, np.number) else _decoded(values, encoding)

    decoded = dtype if plain or not np.issubdtype(dtype, np.number) else np.dtype(np.float64)
    return Variable(name, tuple(stored.dimensions), tuple(stored.shape), decoded, load, attrs, encoding)


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
