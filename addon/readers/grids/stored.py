# SPDX-License-Identifier: GPL-3.0-or-later
"""Variables as a file stores them, before anything is decoded; whatever reads the file gives these."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .dataset import Index


@dataclass(frozen=True, eq=False)
class Stored:
    """read: the values at an index, for each dimension a number or slice(None). attrs: text as str, numbers as NumPy's.
    dtype: in the byte order of this machine; object for text of any length."""

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype
    attrs: Mapping[str, Any]
    read: Callable[[Index], np.ndarray]


@dataclass(frozen=True, eq=False)
class StoredFile:
    """The variables of the file itself, and the names of groups that hold more."""

    variables: tuple[Stored, ...]
    groups: tuple[str, ...] = ()
