# SPDX-License-Identifier: GPL-3.0-or-later
"""The face attribute `sf_morse`: which Morse set every face belongs to (its place in the list), -1 for none."""

import bpy
import numpy as np

ATTRIBUTE = "sf_morse"


def read(mesh: bpy.types.Mesh) -> np.ndarray | None:
    """(m,) int32 per loop triangle; None without the attribute."""
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is None or (attribute.data_type, attribute.domain) != ("INT", "FACE"):
        return None
    sets = np.empty(len(mesh.polygons), np.int32)
    attribute.data.foreach_get("value", sets)
    mesh.calc_loop_triangles()
    return sets[_polygons(mesh)]


def _polygons(mesh: bpy.types.Mesh) -> np.ndarray:
    """The polygon of every loop triangle."""
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return polygons
