# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked λ cache as a field."""

from pathlib import Path

import numpy as np

from ..cache.field_cache import open_cache
from ..model.errors import InputError
from .field_data import FieldData
from .reading import ArrayInfo, Reading


def read_cache(folder: Path, attribute: str) -> FieldData:
    cache = open_cache(folder)
    lambdas = cache.lambdas
    present = cache.sample(0)
    if attribute not in present:
        raise InputError(f"{folder}: has no attribute {attribute}; choose one of {', '.join(sorted(present))}")
    choices = tuple(ArrayInfo(name, "points", _components(values)) for name, values in sorted(present.items()))
    taken = tuple(array for array in choices if array.name == attribute)
    read = Reading((str(folder),), taken, choices)
    return FieldData(cache.mesh, lambdas, cache.values(attribute).astype(np.float64), read)


def _components(values: np.ndarray) -> int:
    return values.shape[1] if values.ndim > 1 else 1
