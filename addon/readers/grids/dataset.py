# SPDX-License-Identifier: GPL-3.0-or-later
"""Named arrays on named dimensions, read when asked for: what is needed of xarray, for single files and without it.

    with netcdf(path) as dataset:                        # netcdf.py
        dataset["u10"].isel({"time": 3}).values      # (latitude, longitude), decoded

Datasets of xarray serve as well: both have the same names for the same things. As there, what says how values are
stored moves from attrs to encoding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

Index = tuple[Any, ...]


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
    """Variables by name; those that are coordinates beside the data. groups: names of those that hold more variables,
    which are not read."""

    def __init__(self, variables: Mapping[str, Variable], coords: set[str], groups: tuple[str, ...] = ()) -> None:
        self.groups = groups
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
        return Dataset({name: one.isel(chosen) for name, one in self.variables.items()}, set(self.coords), self.groups)
