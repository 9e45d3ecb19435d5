# SPDX-License-Identifier: GPL-3.0-or-later
"""Words beside places of an object in the 3D view, where they face the viewer."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from .. import compat
from . import marker_drawing

#: Pixels at 100 % interface scale: size of letters, and from the place to the first one.
SIZE, ASIDE = 12.0, (15.0, 6.0)
#: From the letters to the edge of the plate below them.
PLATE = 4.0
#: Plates that are kept on the GPU while words and view stay.
KEPT = 24


@dataclass(frozen=True)
class Word:
    """Words at pixels of the region."""

    text: str
    x: float
    y: float


def draw(context: bpy.types.Context, matrix_world: Matrix, texts: Iterable[tuple[str, np.ndarray, np.ndarray]]) -> None:
    """texts: words, place (3,) and normal (3,) in the object's space; a normal of zero faces everyone."""
    shown = list(texts)
    if not shown:
        return
    unit = context.preferences.system.ui_scale
    eye = np.array(context.region_data.view_matrix.inverted())
    to_object = np.array(matrix_world.inverted_safe())
    eye = to_object[:3, :3] @ eye[:3, 3] + to_object[:3, 3]
    positions, normals = np.array([place for _, place, _ in shown]), np.array([normal for _, _, normal in shown])
    places = marker_drawing.on_screen(context, matrix_world, positions) + np.array(ASIDE) * unit
    seen = np.isfinite(places[:, 0]) & (((eye - positions) * normals).sum(axis=1) >= 0)
    write([Word(shown[i][0], *places[i].tolist()) for i in np.flatnonzero(seen)], unit)


def write(words: Sequence[Word], unit: float) -> None:
    """White on dark plates."""
    if not words:
        return
    gpu.state.blend_set("ALPHA")
    shader = compat.builtin_shader("UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("color", (0.03, 0.03, 0.04, 0.72))
    _plates(tuple(words), unit).draw(shader)
    blf.size(0, SIZE * unit)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    for word in words:
        blf.position(0, word.x, word.y, 0.0)
        blf.draw(0, word.text)


def forget() -> None:
    _plates.cache_clear()


@lru_cache(maxsize=KEPT)
def _plates(words: tuple[Word, ...], unit: float):
    corners = []
    for word in words:
        width, height = _size(word.text, SIZE * unit)
        left, right, bottom, top = word.x, word.x + width, word.y, word.y + height
        pad = PLATE * unit
        a, b, c, d = left - pad, right + pad, bottom - pad, top + pad
        corners += [(a, c, 0.0), (b, c, 0.0), (b, d, 0.0), (a, c, 0.0), (b, d, 0.0), (a, d, 0.0)]
    return batch_for_shader(compat.builtin_shader("UNIFORM_COLOR"), "TRIS", {"pos": np.array(corners, np.float32)})


@lru_cache(maxsize=512)
def _size(text: str, size: float) -> tuple[float, float]:
    blf.size(0, size)
    return blf.dimensions(0, text)
