# SPDX-License-Identifier: GPL-3.0-or-later
"""A triangle mesh as plain arrays, in the vertex order of the artist's object."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np

from .errors import InputError


@dataclass(frozen=True, eq=False)
class MeshData:
    """vertices (n, 3) float64 in object space, triangles (m, 3) int32, UV layers (m, 3, 2) float32 by name.

    Arrays are converted to these types and made read-only. Raises InputError on shapes that do not fit; what makes a
    surface is checked by the native TriangleMesh.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    uv_layers: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", _array(self.vertices, np.float64, "vertices", (3,)))
        object.__setattr__(self, "triangles", _array(self.triangles, np.int32, "triangles", (3,)))
        layers = {name: _array(uv, np.float32, f"UV layer '{name}'", (3, 2)) for name, uv in self.uv_layers.items()}
        for name, uv in layers.items():
            if len(uv) != len(self.triangles):
                raise InputError(
                    f"UV layer '{name}' has {len(uv)} triangles, the mesh {len(self.triangles)}: give one per triangle"
                )
        object.__setattr__(self, "uv_layers", MappingProxyType(layers))
        if not len(self.triangles):
            raise InputError("the mesh is empty: give it at least one face")

    def fingerprint(self) -> str:
        """SHA-256 of vertices and triangles, hexadecimal: caches belong to one mesh."""
        return self._digest

    @cached_property
    def _digest(self) -> str:
        digest = hashlib.sha256()
        for array in (self.vertices, self.triangles):
            digest.update(repr((array.shape, array.dtype.str)).encode())
            digest.update(np.ascontiguousarray(array).data)
        return digest.hexdigest()


def _array(values, dtype: type, name: str, tail: tuple[int, ...]) -> np.ndarray:
    try:
        array: np.ndarray = np.array(values, dtype=dtype, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} are not numbers: give an array of shape (n, {', '.join(map(str, tail))})") from error
    if array.size == 0:
        array = array.reshape((0, *tail))
    if array.shape[1:] != tail or array.ndim != len(tail) + 1:
        raise InputError(f"{name} have shape {array.shape}: give (n, {', '.join(map(str, tail))})")
    array.setflags(write=False)
    return array
