# SPDX-License-Identifier: GPL-3.0-or-later
"""The face attribute `sf_morse`, as an analysis makes it (scene/read/morse_faces.py reads it)."""

import bpy
import numpy as np

from ..read.current_field import surface_in
from ..read.mesh import read_mesh, read_polygons
from ..read.morse_faces import ATTRIBUTE


def write(obj: bpy.types.Object, triangle_sets: np.ndarray) -> None:
    """triangle_sets: (m,) per triangle of the surface in the object's mesh. A face with triangles in different sets
    belongs to the first of them."""
    mesh = obj.data
    on_mesh = surface_in(obj, read_mesh(obj)).of_triangles(np.asarray(triangle_sets))
    sets = read_polygons(obj).of_triangle_values(on_mesh)
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
