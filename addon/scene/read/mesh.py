# SPDX-License-Identifier: GPL-3.0-or-later
"""The object's own mesh (before any modifier) as arrays: one vertex order for the solver, the cache and Blender.

n-gons are cut by Blender's own loop triangles, so vertex attributes map one to one.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bmesh
import bpy
import numpy as np

from ...model.mesh_data import MeshData
from ...model.polygons import Polygons


def read_mesh(obj: bpy.types.Object) -> MeshData:
    """Vertices in object space, loop triangles and all UV layers of `obj`."""
    with own_mesh(obj) as mesh:
        vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        mesh.vertices.foreach_get("co", vertices)
        triangles, loops = loop_triangles(mesh)
        return MeshData(
            vertices=vertices.reshape(-1, 3).astype(np.float64),
            triangles=triangles,
            uv_layers={layer.name: _uv(layer, len(mesh.loops))[loops] for layer in mesh.uv_layers},
        )


def read_polygons(obj: bpy.types.Object) -> Polygons:
    """The n-gons of `obj`."""
    with own_mesh(obj) as mesh:
        counts = np.empty(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("loop_total", counts)
        return Polygons(counts, corner_vertices(mesh))


@contextmanager
def own_mesh(obj: bpy.types.Object) -> Iterator[bpy.types.Mesh]:
    """The mesh of `obj` as Object Mode has it. In Edit Mode a mesh has no UVs, so that a copy is read."""
    if obj.mode != "EDIT":
        yield obj.data
        return
    obj.update_from_editmode()
    copy = bpy.data.meshes.new("stormfield_edited")
    try:
        bmesh.from_edit_mesh(obj.data).to_mesh(copy)
        yield copy
    finally:
        bpy.data.meshes.remove(copy)


def loop_triangles(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """The vertices and the loops of every triangle, both (m, 3) int32."""
    mesh.calc_loop_triangles()
    loops = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    return corner_vertices(mesh)[loops].reshape(-1, 3), loops.reshape(-1, 3)


def corner_vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    """The vertex of every loop, int32, as Object Mode has them."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    attribute = None if mesh.is_editmode else mesh.attributes.get(".corner_vert")  # Edit Mode has none that can be read
    if attribute is None:
        mesh.loops.foreach_get("vertex_index", corners)
    else:  # as Blender stores them, many times faster
        attribute.data.foreach_get("value", corners)
    return corners


def _uv(layer: bpy.types.MeshUVLoopLayer, loop_count: int) -> np.ndarray:
    uv = np.empty(loop_count * 2, dtype=np.float32)
    layer.uv.foreach_get("vector", uv)
    return uv.reshape(-1, 2)
