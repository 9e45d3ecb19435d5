# SPDX-License-Identifier: GPL-3.0-or-later
"""Which arrays of a surface are the field: what the user names, or the only vector that is no normal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..model.errors import InputError
from .choice import chosen_arrays, listed
from .field_data import LARGEST, NoFieldError
from .grids.missing import CLEAR, LARGE_MARK, MARKS
from .normals import faces_to_vertices, tangent_share
from .raw_surface import CELLS, RawSurface, joined, offered
from .reading import ArrayInfo
from .weld import coincident

Arrays = tuple[ArrayInfo, ...]

#: Less than this part of a vector along the surface, at half of the vertices: the field is a normal.
NORMAL = 0.02
#: The same for vectors of length 1, whose faces may be coarse.
UNIT_NORMAL = 0.15
#: How three scalars are named that are the components of one vector.
TRIPLES = ("xyz", "uvw", "012", "123", "ijk")
#: What graphics programs keep in three numbers.
NO_VECTORS = re.compile(r"^(.*colou?rs?|rgba?|tcoords?|t?ex(ture)?[ _]?coord(inate)?s?|uvw?s?)$", re.IGNORECASE)
NAMED_NORMALS = re.compile(r"^(point|cell|vertex|face|surface|obj)?[ _:]*(normals?|vn|nxnynz|n)_?$", re.IGNORECASE)


@dataclass(frozen=True)
class Taken:
    """The arrays that are the field, and what has to be said of the choice."""

    arrays: Arrays
    notes: tuple[str, ...] = ()


def field_arrays(parts: Sequence[RawSurface], vector: str | None, where: str) -> Taken:
    """Raises InputError where `vector` is not there or is a normal; NoFieldError where nothing says which it is."""
    choices = offered(parts)
    if vector is not None:
        taken = chosen_arrays(vector, choices, where)
        both = [a for a in taken if a.location != CELLS and any(_same_name(a, b) for b in choices)]
        notes = tuple(f"{array.name} is at cells too, cells:{array.name} takes those" for array in both)
        return Taken(taken, notes)
    found = candidates(parts)
    if not found:
        raise NoFieldError(f"{where}: has no vector; {_what_there_is(choices)}")
    if len(found) == 1:
        return Taken(found[0])
    flowing = [arrays for arrays in found if not is_normal(parts, arrays)]
    if not flowing:
        raise NoFieldError(f"{where}: {normal_fault(found[0], choices)}")
    likely = [arrays for arrays in flowing if not _named_normal(arrays)] or flowing
    if len(likely) > 1:
        raise NoFieldError(f"{where}: which array is the field? choose with --vector from: {listed(choices)}")
    return Taken(likely[0], (f"{listed(likely[0])} taken, the other vectors are normals",))


def candidates(parts: Sequence[RawSurface]) -> list[Arrays]:
    """Vectors, and three scalars whose names differ in x, y, z; of equal names those at points. Whole numbers, colours,
    texture coordinates and copies of the positions have to be named."""
    choices = offered(parts)
    at_points = {array.name for array in choices if array.location != CELLS}
    distinct = [array for array in choices if array.location != CELLS or array.name not in at_points]
    plausible = [array for array in distinct if all(_may_flow(part, array) for part in parts if part.has((array,)))]
    return [(array,) for array in plausible if array.components == 3] + _triples(plausible)


def _may_flow(part: RawSurface, array: ArrayInfo) -> bool:
    values = (part.cell_data if array.location == CELLS else part.point_data)[array.name]
    copied = values.shape == part.points.shape and np.array_equal(values, part.points)
    return values.dtype.kind == "f" and not copied and not NO_VECTORS.match(array.name)


def _triples(choices: Sequence[ArrayInfo]) -> list[Arrays]:
    scalars = {(array.location, array.name): array for array in choices if array.components == 1}
    found = []
    for location, name in scalars:
        for letters in (*TRIPLES, *map(str.upper, TRIPLES)):
            for at in {0, len(name) - 1, name.rfind(letters[0])}:
                names = [name[:at] + letter + name[at + 1 :] for letter in letters]
                if at >= 0 and names[0] == name and all((location, other) in scalars for other in names):
                    triple = tuple(scalars[location, other] for other in names)
                    if triple not in found:
                        found.append(triple)
    return found


def is_normal(parts: Sequence[RawSurface], arrays: Arrays) -> bool:
    """Whether the vectors are across the surface nearly everywhere."""
    values = joined([part for part in parts if part.has(arrays)], arrays)
    if values.vectors.shape[1] != 3 or not np.abs(values.vectors).max(initial=0.0) < LARGEST:
        return False
    triangles = coincident(values.points, values.triangles)[values.triangles]
    vectors = values.vectors
    if arrays[0].location == CELLS:
        vectors = faces_to_vertices(values.points, triangles, vectors)
    share = tangent_share(values.points, triangles, vectors)
    return share is not None and looks_normal(share, vectors)


def looks_normal(share: float, vectors: np.ndarray) -> bool:
    """share: the tangent share of vectors (n, 3)."""
    length = np.linalg.norm(vectors, axis=1)
    unit = float(np.mean(np.abs(length - 1.0) < 1e-3)) > 0.9
    return share < (UNIT_NORMAL if unit else NORMAL)


def normal_fault(arrays: Arrays, choices: Sequence[ArrayInfo]) -> str:
    """What is wrong with a normal, and what else there is."""
    others = [array for array in choices if array not in arrays]
    cure = f"choose with --vector from: {listed(others)}" if others else "the file has no other array"
    return f"{listed(arrays)} is normal to the surface nearly everywhere: normals are no field; {cure}"


def three_components(vectors: np.ndarray, arrays: Arrays, points: np.ndarray, where: str) -> np.ndarray:
    """(n, 3). Two components are a vector on a surface in the plane of x and y only."""
    count = vectors.shape[1]
    if count == 3:
        return vectors
    flat = float(np.ptp(points[:, 2])) <= 1e-9 * float(np.ptp(points, axis=0).max())
    if count == 2 and flat:
        return np.column_stack([vectors, np.zeros(len(vectors))])
    more = ", and the surface is not flat in z" if count == 2 else ""
    raise InputError(f"{where}: {listed(arrays)} gives {count} numbers per vector{more}; name a vector of 3")


def _what_there_is(choices: Sequence[ArrayInfo]) -> str:
    if not choices:
        return "it is a mesh without data"
    return f"name one, or three components, with --vector from: {listed(choices)}"


def _same_name(array: ArrayInfo, other: ArrayInfo) -> bool:
    return other.location == CELLS and other.name == array.name


def _named_normal(arrays: Arrays) -> bool:
    name = arrays[0].name if len(arrays) == 1 else "".join(array.name.lower() for array in arrays)
    return bool(NAMED_NORMALS.match(name))


def marked(vectors: np.ndarray) -> np.ndarray:
    """(n,) where all components are one of the numbers that programs write for "no value", far from all others."""
    size = np.abs(vectors).max(axis=1)
    alike = (np.ptp(vectors, axis=1) == 0.0) & (size > 0.0)
    largest = float(size.max(initial=0.0, where=alike))
    known = largest >= LARGE_MARK or any(np.isclose(largest, mark, rtol=1e-6) for mark in MARKS)
    there = alike & (size >= largest * (1.0 - 1e-6))
    others = float(size.max(initial=0.0, where=~there))
    sure = known and (largest >= LARGE_MARK or there.sum() > 1) and others * CLEAR < largest
    return there if sure else np.zeros(len(vectors), bool)
