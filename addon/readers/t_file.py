# SPDX-License-Identifier: GPL-3.0-or-later
"""The .t format: `faces vertices`, then a triangle per row (from 0), a position per row, a vector per row."""

from pathlib import Path

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .field_data import FieldData, steady
from .reading import ArrayInfo, Reading


def read_t(path: Path) -> FieldData:
    try:
        words = path.read_text(encoding="ascii").split()
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file; .t files are") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    try:
        faces, vertices = int(words[0]), int(words[1])
    except (IndexError, ValueError):
        raise InputError(f"{path}: does not begin with the numbers of faces and vertices") from None
    wanted = 2 + 3 * faces + 6 * vertices
    if faces < 1 or vertices < 3 or len(words) < wanted:
        raise InputError(f"{path}: has {len(words)} numbers, but {faces} faces and {vertices} vertices need {wanted}")
    try:
        triangles = np.array(words[2 : 2 + 3 * faces], np.int32).reshape(-1, 3)
        numbers = np.array(words[2 + 3 * faces : wanted], np.float64).reshape(2, vertices, 3)
    except ValueError as error:
        raise InputError(f"{path}: has a word where a number should be ({error})") from None
    vector = (ArrayInfo("vector", "points", 3),)
    return steady(MeshData(numbers[0], triangles), numbers[1], Reading((str(path),), vector, vector))
