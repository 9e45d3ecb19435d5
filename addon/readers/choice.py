# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user chooses of a data set, and which arrays the words of --vector mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..model.errors import InputError
from .reading import ArrayInfo


@dataclass(frozen=True)
class Choice:
    """vector: an array, or its components with commas between; None takes the likely one. sphere_faces: of wind, about.
    attribute: of a cache."""

    vector: str | None = None
    sphere_faces: int | None = None
    attribute: str = "sf_advection"


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
