# SPDX-License-Identifier: GPL-3.0-or-later
"""Words beside places of an object in the 3D view, where they face the viewer."""

from collections.abc import Iterable

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


def draw(context: bpy.types.Context, matrix_world: Matrix, texts: Iterable[tuple[str, np.ndarray, np.ndarray]]) -> None:
    """texts: words, place (3,) and normal (3,) in the object's space; a normal of zero faces everyone."""
    shown = list(texts)
    if not shown:
        return
    unit = context.preferences.system.ui_scale
    eye = np.array(context.region_data.view_matrix.inverted())
    to_object = np.array(matrix_world.inverted_safe())
    eye = to_object[:3, :3] @ eye[:3, 3] + to_object[:3, 3]
    places = marker_drawing.on_screen(context, matrix_world, np.array([place for _, place, _ in shown]))
    for (text, place, normal), (x, y) in zip(shown, places, strict=True):
        if np.isfinite(x) and float(normal @ (eye - place)) >= 0:
            write(text, x + ASIDE[0] * unit, y + ASIDE[1] * unit, unit)


def write(text: str, x: float, y: float, unit: float) -> None:
    """White on a dark plate, at pixels of the region."""
    blf.size(0, SIZE * unit)
    width, height = blf.dimensions(0, text)
    left, right, bottom, top = x - PLATE * unit, x + width + PLATE * unit, y - PLATE * unit, y + height + PLATE * unit
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    shader = compat.builtin_shader("UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("color", (0.03, 0.03, 0.04, 0.72))
    gpu.state.blend_set("ALPHA")
    batch_for_shader(shader, "TRIS", {"pos": [(*corners[i], 0.0) for i in (0, 1, 2, 0, 2, 3)]}).draw(shader)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.position(0, x, y, 0.0)
    blf.draw(0, text)
