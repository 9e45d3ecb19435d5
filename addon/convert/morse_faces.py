"""The face attribute `sf_morse`: which Morse set every face belongs to (its place in the list), -1 for none.

A face with several triangles in different sets belongs to the first of them.
"""

import bpy
import numpy as np

ATTRIBUTE = "sf_morse"


def write(mesh: bpy.types.Mesh, triangle_sets: np.ndarray) -> None:
    """triangle_sets: (m,) per loop triangle, in Blender's order."""
    mesh.calc_loop_triangles()
    faces = _polygons(mesh)
    sets = np.full(len(mesh.polygons), -1, np.int32)
    inside = np.flatnonzero(triangle_sets >= 0)[::-1]  # the first triangle is written last
    sets[faces[inside]] = triangle_sets[inside]
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("INT", "FACE"):
        mesh.attributes.remove(attribute)
        attribute = None
    attribute = attribute or mesh.attributes.new(ATTRIBUTE, "INT", "FACE")
    attribute.data.foreach_set("value", sets)
    mesh.update_tag()


def read(mesh: bpy.types.Mesh) -> np.ndarray | None:
    """(m,) int32 per loop triangle; None without the attribute."""
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is None or (attribute.data_type, attribute.domain) != ("INT", "FACE"):
        return None
    sets = np.empty(len(mesh.polygons), np.int32)
    attribute.data.foreach_get("value", sets)
    mesh.calc_loop_triangles()
    return sets[_polygons(mesh)]


def remove(mesh: bpy.types.Mesh) -> None:
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is not None:
        mesh.attributes.remove(attribute)


def _polygons(mesh: bpy.types.Mesh) -> np.ndarray:
    """The polygon of every loop triangle."""
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return polygons
