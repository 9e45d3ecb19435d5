# SPDX-License-Identifier: GPL-3.0-or-later
"""Imported data as objects: a mesh in a size that fits a scene, speeds in the scene's own time, coasts as a curve."""

from __future__ import annotations

import itertools

import bpy
import numpy as np

from ...cache.field_cache import FieldCache
from ...model.mesh_data import MeshData
from ...readers import FieldData, SceneScale
from ...readers.coasts import Boundary, Line, boundary_lines

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


def boundary_of_globe(data: FieldData) -> Boundary:
    """Coasts and border of data on a sphere; nothing of others."""
    if data.geography is None or not data.geography.spherical:
        return Boundary([], [])
    return boundary_lines(data.mesh, None if data.whole is None else data.whole())


def add_object(context: bpy.types.Context, name: str, mesh: MeshData, boundary: Boundary) -> bpy.types.Object:
    """mesh: of scene_mesh(). Active and selected. A globe that does not cover all has its coasts and the border of the
    data as curves, and the ground below it: children of the object."""
    obj = _add_mesh(context, name, mesh)
    radius = float(np.linalg.norm(mesh.vertices[0]))
    for what, lines in (("Coasts", boundary.coasts), ("Border", boundary.border)):
        if lines:
            _add_child(obj, _curve(f"{obj.name} {what}", mesh.vertices, lines, radius))
    if boundary.coasts or boundary.border:
        _add_child(obj, _ground(f"{obj.name} Ground", GROUND * radius))
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


def _curve(name: str, vertices: np.ndarray, lines: list[Line], radius: float) -> bpy.types.Curve:
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    for line in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(line.vertices) - 1)
        places = np.column_stack([COAST * vertices[line.vertices], np.ones(len(line.vertices))])
        spline.points.foreach_set("co", places.ravel().astype(np.float32))
        spline.use_cyclic_u = line.closed
    curve.bevel_depth = 0.0015 * radius
    return curve


def _ground(name: str, radius: float) -> bpy.types.Mesh:
    import bmesh

    mesh = bpy.data.meshes.new(name)
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=5, radius=radius)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    return mesh


def _add_child(obj: bpy.types.Object, data: bpy.types.ID) -> None:
    child = bpy.data.objects.new(data.name, data)
    child.parent = obj
    child.hide_select = True
    for collection in obj.users_collection:
        collection.objects.link(child)
