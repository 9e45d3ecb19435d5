# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user chooses of a data set, and which arrays the words of --vector mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..model.errors import InputError
from .reading import ArrayInfo

#: Mean radius of the earth, and more than that of any planet.
EARTH_RADIUS_KM, MAX_RADIUS_KM = 6371.0, 1e6


@dataclass(frozen=True)
class Choice:
    """vector: an array, or its components with commas between; None takes the likely one. attribute: of a cache.

    Of grids: level and member, as numbers or words; at: (dimension, value) of any other; times: the first and the last,
    dates or numbers in the file's unit; radius_km: of the sphere; sphere_faces: of one that carries a grid of the whole
    globe, about, None follows the grid."""

    vector: str | None = None
    sphere_faces: int | None = None
    attribute: str = "sf_advection"
    level: str | None = None
    member: str | None = None
    at: tuple[tuple[str, str], ...] = ()
    times: tuple[str, str] | None = None
    radius_km: float = EARTH_RADIUS_KM

    def __post_init__(self) -> None:
        if not 0.0 < self.radius_km <= MAX_RADIUS_KM:
            raise InputError(
                f"--radius {self.radius_km:g} is out of range; give kilometres, {EARTH_RADIUS_KM:g} for the earth"
            )

    def check_without_grid(self, where: str) -> None:
        """Raises InputError where something is chosen that only a grid has: no choice is left aside in silence."""
        given = {**self.by_dimension, **({"times": self.times} if self.times else {})}
        if given:
            option = next(iter(given))
            option = f"--{option}" if option in ("level", "member", "times") else f"--at {option}"
            raise InputError(f"{where}: is no grid, and has nothing to choose by {option}; leave it out")

    @property
    def by_dimension(self) -> dict[str, str]:
        """The chosen values by "level", "member" or name of a dimension."""
        given = {"level": self.level, "member": self.member, **dict(self.at)}
        return {name: value for name, value in given.items() if value is not None}


def chosen_arrays(vector: str, offered: Sequence[ArrayInfo], where: str) -> tuple[ArrayInfo, ...]:
    """The arrays that `vector` names, in its order. A name may hold commas; one that is at points and at cells means
    the first that is offered, or is written "cells:NAME". Raises InputError that lists what there is."""
    arrays: dict[str, ArrayInfo] = {}
    for array in offered:
        arrays.setdefault(array.name.strip(), array)
        arrays[f"{array.location}:{array.name.strip()}"] = array
    names = _names(vector.split(","), arrays)
    if names is None:
        known = {name.strip() for name in vector.split(",")} & set(arrays)
        unknown = next((name.strip() for name in vector.split(",") if name.strip() not in known), vector)
        raise InputError(f"{where}: has no array '{unknown}'; choose from: {listed(offered)}")
    return tuple(arrays[name] for name in names)


def listed(arrays: Sequence[ArrayInfo]) -> str:
    """In words, for messages."""
    return ", ".join(map(str, arrays)) or "none"


def _names(words: list[str], arrays: dict[str, ArrayInfo]) -> list[str] | None:
    """The words joined to names that exist, the longest first; None where that is not possible."""
    if not words:
        return []
    for count in range(len(words), 0, -1):
        name = ",".join(words[:count]).strip()
        if name in arrays:
            rest = _names(words[count:], arrays)
            if rest is not None:
                return [name, *rest]
    return None
