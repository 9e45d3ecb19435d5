# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of edits: a disc, what a drawn loop encloses, faces of an attribute or of a vertex group → plain data."""

from collections.abc import Iterator

import bmesh
import bpy
import numpy as np

from ...model.errors import InputError
from ...model.words import Json
from .curves import read_polylines, take_over_edits
from .facts import shape_of
from .mesh import own_mesh

#: Weight in a vertex group from which on a vertex belongs to the region.
INSIDE = 0.5


def region_json(context: bpy.types.Context, obj: bpy.types.Object, edit) -> dict[str, Json]:
    """As edits.schema.json has it. Raises InputError for a curve, attribute or group that is not there."""
    if edit.region == "DISC":
        if edit.radius <= 0.0:
            raise InputError(f"Edit '{edit.name}': the disc has no radius; give one")
        return {"center": list(edit.center), "radius": edit.radius}
    if edit.region == "LOOP":
        return {"loop": _loop(context, obj, edit).tolist()}
    faces = triangles_of(obj, polygons_of(obj, edit.region, edit.faces, f"Edit '{edit.name}'"))
    if not len(faces):
        raise InputError(f"Edit '{edit.name}': '{edit.faces}' holds no face; choose faces of '{obj.name}'")
    return {"faces": faces.tolist()}


def polygons_of(obj: bpy.types.Object, region: str, name: str, what: str) -> np.ndarray:
    """(p,) bool: the faces of an attribute or, where region is GROUP, of a vertex group. what: of messages. Raises
    InputError where there is none. Writes nothing, so that panels may ask, in Edit Mode too."""
    group = region == "GROUP"
    if group and obj.vertex_groups.get(name) is None:
        raise InputError(f"{what}: '{obj.name}' has no vertex group '{name}'")
    shape = bmesh.from_edit_mesh(obj.data) if obj.mode == "EDIT" else bmesh.new()
    try:
        if obj.mode != "EDIT":
            shape.from_mesh(obj.data)
        inside = _of_group(obj, shape, name) if group else _of_attribute(shape, name)
    finally:
        if obj.mode != "EDIT":
            shape.free()
    if inside is None:
        raise InputError(f"{what}: '{obj.name}' has no boolean attribute '{name}' of faces")
    return np.array(inside, bool)


def triangles_of(obj: bpy.types.Object, polygons: np.ndarray) -> np.ndarray:
    """Numbers of the triangles of these faces, (p,) bool."""
    with own_mesh(obj) as mesh:
        mesh.calc_loop_triangles()
        owner = np.empty(len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", owner)
        return np.flatnonzero(polygons[owner])


def facts_of(obj: bpy.types.Object, edit) -> Iterator[object]:
    """What the region is made from, to know when it is another."""
    if edit.region in {"FACES", "GROUP"}:
        try:
            yield polygons_of(obj, edit.region, edit.faces, "")
        except InputError as fault:
            yield str(fault)
    source = edit.loop if edit.region == "LOOP" else None
    if source is not None:
        yield from shape_of(source)
        yield np.round(np.array(obj.matrix_world.inverted_safe() @ source.matrix_world), 5)


def line_of(context: bpy.types.Context, obj: bpy.types.Object, source, what: str) -> np.ndarray:
    """(n, 3) the first line of a curve, in the object's space. what: of messages. Raises InputError without one."""
    if source is None:
        raise InputError(f"{what} has no curve; choose one")
    take_over_edits([source])
    inverse = obj.matrix_world.inverted_safe()
    lines = read_polylines(source, context.evaluated_depsgraph_get(), inverse)
    if not lines:
        raise InputError(f"{what}: '{source.name}' has no points yet; draw on the surface")
    return lines[0]


def _loop(context: bpy.types.Context, obj: bpy.types.Object, edit) -> np.ndarray:
    line = line_of(context, obj, edit.loop, f"Edit '{edit.name}'")
    if len(line) > 1 and np.allclose(line[0], line[-1]):
        line = line[:-1]
    if len(line) < 3:
        raise InputError(f"Edit '{edit.name}': '{edit.loop.name}' has {len(line)} points; a loop needs three or more")
    return line


def _of_attribute(shape: bmesh.types.BMesh, name: str) -> list[bool] | None:
    layer = shape.faces.layers.bool.get(name)
    return None if layer is None else [face[layer] for face in shape.faces]


def _of_group(obj: bpy.types.Object, shape: bmesh.types.BMesh, name: str) -> list[bool]:
    number, layer = obj.vertex_groups[name].index, shape.verts.layers.deform.active
    if layer is None:  # no vertex has a weight
        return [False] * len(shape.faces)
    inside = [vertex[layer].get(number, 0.0) >= INSIDE for vertex in shape.verts]
    return [all(inside[vertex.index] for vertex in face.verts) for face in shape.faces]
