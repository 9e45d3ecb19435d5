# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes to design on: Blender's monkey, its voxel remesh, a mannequin's head of our own, a ring."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from mathutils import Vector

# Balls (place, radii) that melt into a head on a neck and shoulders; the face looks along -y.
HEAD = (
    ((0.00, 0.08, 0.40), (0.66, 0.80, 0.74)),  # skull
    ((0.00, -0.14, 0.00), (0.56, 0.62, 0.72)),  # face
    ((0.00, -0.30, -0.42), (0.33, 0.36, 0.34)),  # jaw
    ((0.00, 0.20, -0.60), (0.31, 0.33, 0.90)),  # neck
    ((0.00, 0.20, -1.45), (0.62, 0.42, 0.42)),  # shoulders
    ((0.45, 0.20, -1.55), (0.55, 0.40, 0.36)),
    ((-0.45, 0.20, -1.55), (0.55, 0.40, 0.36)),
    ((0.00, 0.04, -1.62), (0.80, 0.55, 0.42)),  # chest
)


def _take_evaluated(obj: bpy.types.Object, name: str) -> bpy.types.Mesh:
    """The object's mesh after its modifiers."""
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = bpy.data.meshes.new_from_object(evaluated)
    mesh.name = name
    return mesh


def _replaced(scene: bpy.types.Scene, obj: bpy.types.Object, name: str) -> bpy.types.Object:
    """A plain mesh object in the place of one with modifiers."""
    mesh = _take_evaluated(obj, name)
    bpy.data.objects.remove(obj)
    result = bpy.data.objects.new(name, mesh)
    result.data.shade_smooth()
    scene.collection.objects.link(result)
    return result


def add_monkey(scene: bpy.types.Scene, subdivisions: int = 3, voxel_size: float = 0.0) -> bpy.types.Object:
    """Suzanne with her subdivision applied: three components, with boundaries. With a voxel size her remesh: one
    closed surface."""
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    surface = monkey.modifiers.new("Subdivision", "SUBSURF")
    surface.levels = subdivisions
    if voxel_size > 0:
        remesh = monkey.modifiers.new("Remesh", "REMESH")
        remesh.mode, remesh.voxel_size = "VOXEL", voxel_size
        smooth = monkey.modifiers.new("Smooth", "SMOOTH")
        smooth.factor, smooth.iterations = 0.5, 4
    return _replaced(scene, monkey, "Suzanne Remeshed" if voxel_size > 0 else "Suzanne")


def add_head(scene: bpy.types.Scene, voxel_size: float = 0.04) -> bpy.types.Object:
    """A mannequin's head: balls joined by a voxel remesh and smoothed."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    ball = bpy.context.object
    parts = []
    for place, radii in HEAD:
        part = bpy.data.objects.new("Ball", ball.data.copy())
        part.location, part.scale = place, radii
        scene.collection.objects.link(part)
        parts.append(part)
    bpy.data.objects.remove(ball)
    with bpy.context.temp_override(active_object=parts[0], selected_editable_objects=parts, selected_objects=parts):
        bpy.ops.object.join()
    body = parts[0]
    remesh = body.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", voxel_size
    smooth = body.modifiers.new("Smooth", "SMOOTH")
    smooth.factor, smooth.iterations = 0.5, 120
    matrix = body.matrix_world.copy()
    head = _replaced(scene, body, "Mannequin")
    head.data.transform(matrix)
    return head


def front_points(obj: bpy.types.Object, places: Sequence[tuple[float, float]]) -> list[Vector]:
    """Points of the surface that a viewer in front (looking along +y) sees at those (x, z), in object space."""
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = []
    for x, z in places:
        hit, point, _normal, _face = evaluated.ray_cast(Vector((x, -10.0, z)), Vector((0.0, 1.0, 0.0)))
        if not hit:
            raise ValueError(f"'{obj.name}' has no surface in front of x {x:g}, z {z:g}")
        points.append(point)
    return points


def add_ring(scene: bpy.types.Scene, major: float = 1.0, minor: float = 0.42, detail: int = 0) -> bpy.types.Object:
    """A torus around z."""
    segments = 192 if detail >= 0 else 192 // 2**-detail
    bpy.ops.mesh.primitive_torus_add(
        major_radius=major, minor_radius=minor, major_segments=segments, minor_segments=segments * 5 // 12
    )
    ring = bpy.context.object
    ring.name = ring.data.name = "Ring"
    ring.data.shade_smooth()
    return ring
