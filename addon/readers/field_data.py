# SPDX-License-Identifier: GPL-3.0-or-later
"""What every reader returns."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol, overload

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .geography import Geography
from .reading import Reading

#: Squares and determinants of numbers up to this stay finite, and those of its inverse are not zero.
LARGEST = 1e60


class NoFieldError(InputError):
    """The file is a mesh, but nothing says which of its data is the field."""


class Samples(Protocol):
    """(s, n, 3) vectors whose samples are read when asked for; an array is one. A slice reads nothing."""

    @property
    def shape(self) -> tuple[int, ...]: ...

    def __len__(self) -> int: ...

    @overload
    def __getitem__(self, j: int, /) -> np.ndarray: ...

    @overload
    def __getitem__(self, j: slice, /) -> Samples: ...

    def __iter__(self) -> Iterator[np.ndarray]: ...


@dataclass(frozen=True, eq=False)
class FieldData:
    """vectors (s, n, 3) float64 in space, one per sample and vertex, in memory or read one after another; lambdas (s,)
    increasing in 0..1; read says where they come from; geography, where on the earth and when. whole: makes the mesh as
    it would be if no value were missing, where some are."""

    mesh: MeshData
    lambdas: np.ndarray
    vectors: Samples
    read: Reading = field(default_factory=Reading)
    geography: Geography | None = None
    whole: Callable[[], MeshData] | None = None

    def __post_init__(self) -> None:
        wanted, where = (len(self.lambdas), len(self.mesh.vertices), 3), self.read.name()
        if self.vectors.shape != wanted:
            raise InputError(f"{where}the field has shape {self.vectors.shape} on a mesh that needs {wanted}")
        if not isinstance(self.vectors, np.ndarray):
            return  # readers of large data check each sample as they read it
        bad = np.unique(np.argwhere(~np.isfinite(self.vectors).all(axis=2))[:, 1])
        if len(bad):
            others = f", nor are those of {len(bad) - 1} others" if len(bad) > 1 else ""
            raise InputError(f"{where}the vector of vertex {bad[0]} is not finite{others}; repair or remove it")
        check_numbers(where, "mesh", self.mesh.vertices)
        check_numbers(where, "field", self.vectors)

    def at(self, lam: float) -> np.ndarray:
        """(n, 3) at λ, linear between samples, constant outside."""
        j = int(np.clip(np.searchsorted(self.lambdas, lam, side="right") - 1, 0, len(self.lambdas) - 1))
        if j == len(self.lambdas) - 1 or lam <= self.lambdas[j]:
            return self.vectors[j]
        weight = (lam - self.lambdas[j]) / (self.lambdas[j + 1] - self.lambdas[j])
        return (1.0 - weight) * self.vectors[j] + weight * self.vectors[j + 1]


def check_numbers(where: str, what: str, numbers: np.ndarray) -> None:
    """Raises InputError where the finite numbers of a mesh or field are all zero, too large or too small to compute
    with. where: the beginning of the message, file and colon."""
    largest = float(np.abs(numbers).max(initial=0.0))
    if largest == 0.0:
        raise InputError(f"{where}the {what} is zero everywhere; nothing can be found in it")
    if not 1.0 / LARGEST < largest < LARGEST:
        raise InputError(
            f"{where}the largest number of the {what} is {largest:.3g}, which cannot be computed with; "
            "choose another unit, or repair it"
        )


def steady(mesh: MeshData, vectors: np.ndarray, read: Reading | None = None) -> FieldData:
    """A field that does not change with λ."""
    return FieldData(mesh, np.zeros(1), np.asarray(vectors, np.float64)[None], read or Reading())


def lambdas_of(times: np.ndarray, where: str) -> np.ndarray:
    """(s,) increasing times as λ from 0 to 1, linear in time, so that gaps stay gaps. Raises InputError."""
    times = np.asarray(times, np.float64)
    if len(times) == 1:
        return np.zeros(1)
    steps = np.diff(times)
    wrong = np.flatnonzero(~(steps > 0.0))
    if len(wrong):
        j = int(wrong[0])
        raise InputError(f"{where}: time {times[j + 1]:g} follows {times[j]:g}; give times that increase")
    return (times - times[0]) / (times[-1] - times[0])
