# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as its file has it: triangles with whatever data they carry, not yet joined at seams."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .reading import ArrayInfo

POINTS, CELLS = "points", "cells"


@dataclass(frozen=True, eq=False)
class RawSurface:
    """points (n, 3); triangles (m, 3) of their numbers; point_data (n, k) and cell_data (m, k) by name, one value of
    cell data per triangle; units by name. volume: these are the outer faces of volume cells. time: as the
    file says. changes: what was done to
    get triangles, and how often."""

    points: np.ndarray
    triangles: np.ndarray
    point_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    name: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    volume: bool = False
    time: float | None = None
    changes: Mapping[str, int] = field(default_factory=dict)

    def arrays(self) -> list[ArrayInfo]:
        """What there is to choose, points first; colours are not."""
        return [
            ArrayInfo(name, location, data[name].shape[1], self.units.get(name, ""))
            for location, data in ((POINTS, self.point_data), (CELLS, self.cell_data))
            for name in sorted(data)
            if data[name].dtype != np.uint8
        ]

    def has(self, arrays: Sequence[ArrayInfo]) -> bool:
        return all(array.name in self._of(array) for array in arrays)

    def values(self, arrays: Sequence[ArrayInfo]) -> np.ndarray:
        """The arrays side by side, float64, one row per point or triangle."""
        return np.concatenate([np.asarray(self._of(array)[array.name], np.float64) for array in arrays], axis=1)

    def _of(self, array: ArrayInfo) -> Mapping[str, np.ndarray]:
        return self.cell_data if array.location == CELLS else self.point_data


def plain_surface(
    points: np.ndarray,
    cells: list[np.ndarray],
    point_data: Mapping[str, np.ndarray],
    cell_data: Mapping[str, np.ndarray],
) -> RawSurface:
    """Triangles and quads; a quad is cut along its shorter diagonal."""
    corners = np.array([len(cell) for cell in cells])
    three, four = np.flatnonzero(corners == 3), np.flatnonzero(corners == 4)
    triangles = np.array([cells[k] for k in three], np.int64).reshape(-1, 3)
    quads = np.array([cells[k] for k in four], np.int64).reshape(-1, 4)
    side = np.linalg.norm(points[quads[:, 0]] - points[quads[:, 2]], axis=1)
    other = np.linalg.norm(points[quads[:, 1]] - points[quads[:, 3]], axis=1)
    first = np.where((side <= other)[:, None], quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    second = np.where((side <= other)[:, None], quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    cell = np.concatenate([three, four, four])
    order = np.argsort(cell, kind="stable")
    return RawSurface(
        points=points,
        triangles=np.concatenate([triangles, first, second])[order],
        point_data=point_data,
        cell_data={name: values[cell[order]] for name, values in cell_data.items()},
        changes={"polygons or strips cut into triangles": len(four)},
    )


@dataclass(frozen=True, eq=False)
class Values:
    """One choice of arrays on the parts that carry it: points (n, 3), triangles (m, 3), vectors (n or m, k)."""

    points: np.ndarray
    triangles: np.ndarray
    vectors: np.ndarray


def offered(parts: Sequence[RawSurface]) -> tuple[ArrayInfo, ...]:
    """What can be chosen of all parts together, points first, each once."""
    found = {(array.location, array.name): array for part in reversed(parts) for array in part.arrays()}
    return tuple(sorted(found.values(), key=lambda array: (array.location == CELLS, array.name)))


def joined(parts: Sequence[RawSurface], arrays: Sequence[ArrayInfo]) -> Values:
    """The parts behind each other. Without arrays vectors are (n, 0)."""
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    return Values(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, first, strict=False)]),
        np.concatenate([part.values(arrays) if arrays else np.zeros((len(part.points), 0)) for part in parts]),
    )
