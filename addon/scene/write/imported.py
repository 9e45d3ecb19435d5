# SPDX-License-Identifier: GPL-3.0-or-later
"""Imported data as objects: a mesh in a size that fits a scene, speeds in the scene's own time, coasts as a curve."""

from __future__ import annotations

import itertools

import bpy
import numpy as np

from ...cache.field_cache import FieldCache
from ...model.mesh_data import MeshData
from ...readers import FieldData, SceneScale

#: Radius of the ground below a globe with coasts, and of their curve, over that of the globe.
GROUND, COAST = 0.998, 1.001
#: Custom property of an object: what was read, in words.
READ = "stormfield_read"


def free_name(name: str) -> str:
    """The name that Blender will give to a new object for which this is wished."""
    names = itertools.chain([name], (f"{name}.{number:03}" for number in itertools.count(1)))
    return next(name for name in names if name not in bpy.data.objects)


def scene_mesh(data: FieldData, scale: SceneScale) -> MeshData:
    """The mesh of the data as an object will have it: in the scene's size and Blender's precision."""
    return MeshData((scale.lengths * data.mesh.vertices).astype(np.float32), data.mesh.triangles)


def add_object(context: bpy.types.Context, name: str, mesh: MeshData, data: FieldData) -> bpy.types.Object:
    """mesh: of scene_mesh(). Active and selected, with its coasts where a globe has some."""
    obj = _add_mesh(context, name, mesh)
    if data.geography is not None and data.geography.spherical:
        loops = boundary_loops(mesh.triangles)
        if loops:
            _add_coasts(obj, mesh.vertices, loops)
    return obj


def add_cache_object(context: bpy.types.Context, cache: FieldCache) -> bpy.types.Object:
    """The mesh of a λ cache, with the polygons of the artist."""
    return _add_mesh(context, cache.folder.parent.name, cache.mesh)


def remember(obj: bpy.types.Object, data: FieldData) -> None:
    """What was read, and the first and the last time, as custom properties."""
    obj[READ] = data.read.line()
    times = None if data.geography is None else data.geography.times([0.0, 1.0])
    if times is not None:
        obj["stormfield_times"] = [str(time) for time in times]


def boundary_loops(triangles: np.ndarray) -> list[np.ndarray]:
    """Vertices of every boundary loop of an oriented mesh, in order."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max()) + 1
    back = np.isin(start.astype(np.int64) * count + end, end.astype(np.int64) * count + start)
    after = dict(zip(start[~back].tolist(), end[~back].tolist(), strict=True))
    loops = []
    while after:
        first, vertex = after.popitem()
        loop = [first]
        while vertex != first:
            loop.append(vertex)
            vertex = after.pop(vertex)
        loops.append(np.array(loop))
    return loops


def _add_mesh(context: bpy.types.Context, name: str, data: MeshData) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(data.vertices))
    mesh.vertices.foreach_set("co", data.vertices.astype(np.float32).ravel())
    mesh.loops.add(data.triangles.size)
    mesh.loops.foreach_set("vertex_index", data.triangles.ravel())
    mesh.polygons.add(len(data.triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, data.triangles.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    obj = bpy.data.objects.new(name, mesh)
    context.scene.collection.objects.link(obj)
    for other in context.selected_objects:
        other.select_set(False)
    context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def _add_coasts(obj: bpy.types.Object, vertices: np.ndarray, loops: list[np.ndarray]) -> None:
    """The border of the data as one curve, and the ground below it: children of the object."""
    curve = bpy.data.curves.new(f"{obj.name} Coasts", "CURVE")
    curve.dimensions = "3D"
    for loop in loops:
        spline = curve.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        places = np.column_stack([COAST * vertices[loop], np.ones(len(loop))])
        spline.points.foreach_set("co", places.ravel().astype(np.float32))
        spline.use_cyclic_u = True
    radius = float(np.linalg.norm(vertices[0]))
    curve.bevel_depth = 0.0015 * radius
    ground = bpy.data.meshes.new(f"{obj.name} Ground")
    _fill_sphere(ground, GROUND * radius)
    for data in (curve, ground):
        child = bpy.data.objects.new(data.name, data)
        child.parent = obj
        child.hide_select = True
        for collection in obj.users_collection:
            collection.objects.link(child)


def _fill_sphere(mesh: bpy.types.Mesh, radius: float) -> None:
    import bmesh

    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=5, radius=radius)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
