# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in the 3D view that keep their width on screen."""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from .. import compat


def batch(ends: np.ndarray, colours: np.ndarray):
    """Segments (l, 2, 3) with colours (l, 2, 4), sent to the GPU."""
    content = {"pos": ends.reshape(-1, 3), "color": colours.reshape(-1, 4)}
    # Blender reads the bytes as they lie.
    return batch_for_shader(_shader(), "LINES", {k: np.ascontiguousarray(v, np.float32) for k, v in content.items()})


def draw(context: bpy.types.Context, matrix_world: Matrix, made, width: float) -> None:
    """Draw a batch of an object's own space; width: pixels."""
    shader = _shader()
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(matrix_world)
        shader.bind()
        shader.uniform_float("viewportSize", (context.region.width, context.region.height))
        shader.uniform_float("lineWidth", width)
        made.draw(shader)


def _shader():
    return compat.builtin_shader("POLYLINE_SMOOTH_COLOR")
