# SPDX-License-Identifier: GPL-3.0-or-later
"""The face attribute `sf_morse`, as an analysis makes it (scene/read/morse_faces.py reads it)."""

import bpy
import numpy as np

from ..read.mesh import read_polygons
from ..read.morse_faces import ATTRIBUTE


def write(obj: bpy.types.Object, triangle_sets: np.ndarray) -> None:
    """triangle_sets: (m,) per loop triangle, in Blender's order. A face with triangles in different sets belongs to the
    first of them."""
    mesh = obj.data
    sets = read_polygons(obj).of_triangle_values(np.asarray(triangle_sets))
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("INT", "FACE"):
        mesh.attributes.remove(attribute)
        attribute = None
    attribute = attribute or mesh.attributes.new(ATTRIBUTE, "INT", "FACE")
    attribute.data.foreach_set("value", sets)
    mesh.update_tag()


def remove(mesh: bpy.types.Mesh) -> None:
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is not None:
        mesh.attributes.remove(attribute)
