# SPDX-License-Identifier: GPL-3.0-or-later
"""What every reader returns."""

from dataclasses import dataclass, field

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .reading import Reading


class NoFieldError(InputError):
    """The file is a mesh, but nothing says which of its data is the field."""


@dataclass(frozen=True, eq=False)
class FieldData:
    """vectors (s, n, 3) float64 in space, one per sample and vertex; lambdas (s,) increasing in 0..1; read says where
    they come from."""

    mesh: MeshData
    lambdas: np.ndarray
    vectors: np.ndarray
    read: Reading = field(default_factory=Reading)

    def __post_init__(self) -> None:
        wanted = (len(self.lambdas), len(self.mesh.vertices), 3)
        if self.vectors.shape != wanted:
            raise InputError(f"the field has shape {self.vectors.shape} on a mesh that needs {wanted}")
        bad = np.argwhere(~np.isfinite(self.vectors).all(axis=2))
        if len(bad):
            raise InputError(f"the vector of vertex {bad[0][1]} is not finite; repair or remove it")

    def at(self, lam: float) -> np.ndarray:
        """(n, 3) at λ, linear between samples, constant outside."""
        j = int(np.clip(np.searchsorted(self.lambdas, lam, side="right") - 1, 0, len(self.lambdas) - 1))
        if j == len(self.lambdas) - 1 or lam <= self.lambdas[j]:
            return self.vectors[j]
        weight = (lam - self.lambdas[j]) / (self.lambdas[j + 1] - self.lambdas[j])
        return (1.0 - weight) * self.vectors[j] + weight * self.vectors[j + 1]


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
