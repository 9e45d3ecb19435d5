# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of a pair of variables, one time after another, so that memory holds one."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Protocol, overload

import numpy as np

from ...model.errors import InputError
from ...work import Step, Steps
from ..field_data import check_numbers
from .components import Pair
from .missing import undeclared, without_declared
from .surface import Surface

#: Components of a grid: u and v, NaN where there is no value.
Sample = tuple[np.ndarray, np.ndarray]

#: Samples of fewer numbers than this stay in memory once they are read: half a gigabyte.
KEPT_NUMBERS = 1 << 26


@dataclass(frozen=True, eq=False)
class Components:
    """Reads u and v of each time. opened: gives the dataset for as long as it is needed; a file that is open twice
    crashes the library that reads it. over: the dimension of time, None where there is none; times: the places along
    it. speed: metres per second of one unit, None for data that are no speed."""

    opened: Callable[[], AbstractContextManager]
    pair: Pair
    dims: tuple[str, ...]
    fixed: Mapping[str, int]
    over: str | None
    times: np.ndarray
    speed: float | None
    where: str

    def __len__(self) -> int:
        return len(self.times)

    @overload
    def __getitem__(self, j: int) -> Sample: ...

    @overload
    def __getitem__(self, j: slice) -> Components: ...

    def __getitem__(self, j: int | slice) -> Sample | Components:
        if isinstance(j, slice):
            return replace(self, times=self.times[j])
        with self.opened() as dataset:
            return self._read(dataset, j)[0]

    def __iter__(self) -> Iterator[Sample]:
        return (sample for sample, _ in self.with_marks())

    def with_marks(self) -> Iterator[tuple[Sample, list[float]]]:
        """Every sample, and the undeclared marks of no value in it."""
        with self.opened() as dataset:
            for j in range(len(self)):
                yield self._read(dataset, j)

    def _read(self, dataset, j: int) -> tuple[Sample, list[float]]:
        east, north = (self._one(dataset[name], j) for name in (self.pair.east, self.pair.north))
        u, v = _centred(east, north, self.where)
        no_value, marks = undeclared(u, v, self.speed)
        none = no_value | ~np.isfinite(u) | ~np.isfinite(v)
        factor = 1.0 if self.speed is None else self.speed
        return (np.where(none, np.nan, u * factor), np.where(none, np.nan, v * factor)), marks

    def _one(self, variable, j: int) -> np.ndarray:
        chosen = dict(self.fixed) | ({self.over: int(self.times[j])} if self.over is not None else {})
        chosen = {dim: index for dim, index in chosen.items() if dim in variable.dims}
        array = variable.isel(chosen)
        # The dimensions of a staggered component have names of their own, in the same order.
        order = [dim for dim in self.dims if dim in array.dims]
        if len(order) == array.ndim:
            array = array.transpose(*order)
        try:
            values = array.values
        except Exception as error:
            raise InputError(f"{self.where}: {variable.name} cannot be read at time {j} ({error})") from error
        return without_declared(variable, np.asarray(values, np.float64))


@dataclass(frozen=True, eq=False)
class Kept:
    """Components that are in memory. A process that they are sent to reads them itself."""

    components: Components
    samples: Sequence[Sample]

    def __len__(self) -> int:
        return len(self.samples)

    @overload
    def __getitem__(self, j: int) -> Sample: ...

    @overload
    def __getitem__(self, j: slice) -> Kept: ...

    def __getitem__(self, j: int | slice) -> Sample | Kept:
        return Kept(self.components[j], self.samples[j]) if isinstance(j, slice) else self.samples[j]

    def __iter__(self) -> Iterator[Sample]:
        return iter(self.samples)

    def __reduce__(self):
        return copy.copy, (self.components,)


@dataclass(frozen=True, eq=False)
class Scan:
    """What all samples say together. samples: the same components, in memory where they are small. valid: where none
    misses its value."""

    samples: Collection
    first: Sample
    valid: np.ndarray
    marks: tuple[float, ...]
    varying: int  #: places that miss their value at some times only
    zero: int  #: places where every value is zero
    empty: tuple[int, ...]  #: samples without any value


def scan(components: Components) -> Steps[Scan]:
    """Reads every sample once, one after another."""
    always, ever, zero, first = None, None, None, None
    largest = np.zeros(1)
    marks: set[float] = set()
    empty: list[int] = []
    kept: list[Sample] | None = []
    for j, ((u, v), found) in enumerate(components.with_marks()):
        yield Step((j + 1) / len(components), f"Reading time {j + 1} of {len(components)}")
        first = (u, v) if first is None else first
        if kept is not None:
            kept = [*kept, (u, v)] if (j + 1) * 2 * u.size < KEPT_NUMBERS else None
        present = np.isfinite(u)
        marks |= set(found)
        if not present.any():
            empty.append(j)
            continue
        calm = (u == 0.0) & (v == 0.0)
        largest = np.fmax(largest, np.fmax(np.abs(u), np.abs(v)))
        always = present if always is None else always & present
        ever = present if ever is None else ever | present
        zero = calm if zero is None else zero & calm
    if always is None or ever is None or zero is None or first is None:
        raise InputError(f"{components.where}: no value is finite and possible as a speed; nothing is left to analyze")
    check_numbers(f"{components.where}: ", "field", np.where(always, largest, 0.0))
    varying = int((ever & ~always).sum())
    samples = components if kept is None else Kept(components, kept)
    return Scan(samples, first, always, tuple(sorted(marks)), varying, int(zero.sum()), tuple(empty))


class Collection(Protocol):
    """Samples by their number."""

    def __len__(self) -> int: ...

    @overload
    def __getitem__(self, j: int, /) -> Sample: ...

    @overload
    def __getitem__(self, j: slice, /) -> Collection: ...

    def __iter__(self) -> Iterator[Sample]: ...


@dataclass(frozen=True, eq=False)
class GridSamples:
    """The vectors (n, 3) of each sample, made when asked for. Has the shape of the array it stands for."""

    samples: Collection
    surface: Surface

    @property
    def shape(self) -> tuple[int, int, int]:
        return len(self.samples), len(self.surface.mesh.vertices), 3

    def __len__(self) -> int:
        return len(self.samples)

    @overload
    def __getitem__(self, j: int) -> np.ndarray: ...

    @overload
    def __getitem__(self, j: slice) -> GridSamples: ...

    def __getitem__(self, j: int | slice) -> np.ndarray | GridSamples:
        if isinstance(j, slice):
            return replace(self, samples=self.samples[j])
        if not -len(self) <= j < len(self):
            raise IndexError(j)
        return self.surface.vectors(*self.samples[j % len(self)])

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self.surface.vectors(u, v) for u, v in self.samples)

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        return np.stack(list(self)).astype(np.float64 if dtype is None else dtype)


def _centred(u: np.ndarray, v: np.ndarray, where: str) -> tuple[np.ndarray, np.ndarray]:
    """Both components in the middle of the cells, where a staggered grid has them on the sides."""
    if u.shape == v.shape:
        return u, v
    if u.ndim == 2 and v.ndim == 2:
        wider, higher = u.shape[1] - v.shape[1], v.shape[0] - u.shape[0]
        if wider == higher == 1:
            return 0.5 * (u[:, 1:] + u[:, :-1]), 0.5 * (v[1:] + v[:-1])
        if wider == higher == -1:
            return 0.5 * (u[1:-1, 1:] + u[1:-1, :-1]), 0.5 * (v[1:, 1:-1] + v[:-1, 1:-1])
    raise InputError(
        f"{where}: the components have shapes {u.shape} and {v.shape}: a staggered grid that is not known; bring both "
        "to the middle of its cells first"
    )
