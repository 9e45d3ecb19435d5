# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked λ cache as a field."""

from pathlib import Path

import numpy as np

from ..cache.field_cache import open_cache
from ..model.errors import InputError
from .field_data import FieldData


def read_cache(folder: Path, attribute: str) -> FieldData:
    cache = open_cache(folder)
    lambdas = cache.lambdas
    present = cache.sample(0)
    if attribute not in present:
        raise InputError(f"{folder}: has no attribute {attribute}; choose one of {', '.join(sorted(present))}")
    return FieldData(cache.mesh, lambdas, cache.values(attribute).astype(np.float64))
