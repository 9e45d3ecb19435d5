# SPDX-License-Identifier: GPL-3.0-or-later
"""What scene presets are put together from: curves on the surface, elements, λ keys, camera and light."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import bmesh
import bpy
from mathutils import Vector

from ..scene.write.lambda_keys import key_lambda_over_scene

Point = Sequence[float]


def add_icosphere(scene: bpy.types.Scene, name: str, subdivisions: int) -> bpy.types.Object:
    """The unit sphere; the subdivisions are those of Blender's own icosphere."""
    mesh = bpy.data.meshes.new(name)
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=subdivisions, radius=1.0)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    obj = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(obj)
    return obj


def concentrate(sphere: bpy.types.Mesh, place: Point, factor: float) -> None:
    """Make the unit sphere's faces smaller around a place, by that factor, and larger on the other side.

    The Möbius map tan(θ'/2) = tan(θ/2) / factor of the angle θ to the place: it keeps the faces' shapes."""
    axis = Vector(place).normalized()
    for vertex in sphere.vertices:
        height = axis.dot(vertex.co)
        aside = vertex.co - height * axis
        tangent = aside.length / max(1.0 + height, 1e-9) / factor  # tan of half the new angle
        if aside.length > 1e-9:
            angle = 2.0 * math.atan(tangent)
            vertex.co = math.cos(angle) * axis + math.sin(angle) * aside.normalized()


def element_collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> bpy.types.Collection:
    """The collection of the curves that design the object's field: visible while working, never rendered."""
    collection = bpy.data.collections.new(f"{obj.name} Elements")
    scene.collection.children.link(collection)
    collection.hide_render = True
    return collection


def curve_object(
    name: str,
    points: Iterable[Point],
    collection: bpy.types.Collection,
    parent: bpy.types.Object | None = None,
    cyclic: bool = False,
) -> bpy.types.Object:
    """A polyline as a curve object, in the space of its parent."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    corners = [(*point, 1.0) for point in points]
    spline = curve.splines.new("POLY")
    spline.points.add(len(corners) - 1)
    for target, corner in zip(spline.points, corners, strict=True):
        target.co = corner
    spline.use_cyclic_u = cyclic
    obj = bpy.data.objects.new(name, curve)
    obj.parent = parent
    collection.objects.link(obj)
    return obj


def empty_object(name: str, place: Point, collection: bpy.types.Collection, size: float = 0.1) -> bpy.types.Object:
    empty = bpy.data.objects.new(name, None)
    empty.location, empty.empty_display_size = place, size
    collection.objects.link(empty)
    return empty


def add_element(obj: bpy.types.Object, source: bpy.types.Object, **settings: object) -> None:
    """One more design element on the object; the settings are those of ``ElementProperties``."""
    element = obj.stormfield.elements.add()
    element.name, element.source = source.name, source
    for name, value in settings.items():
        setattr(element, name, value)


def look_at(obj: bpy.types.Object, target: Point) -> None:
    obj.rotation_euler = (Vector(target) - obj.location).to_track_quat("-Z", "Y").to_euler()


def add_camera(scene: bpy.types.Scene, place: Point, target: Point, lens: float) -> bpy.types.Object:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.data.lens = place, lens
    look_at(camera, target)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def add_sun(
    scene: bpy.types.Scene, direction: Point, energy: float, color: Point = (1.0, 1.0, 1.0), shadow: bool = True
) -> bpy.types.Object:
    """Sunlight from that direction."""
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.color, sun.data.angle = energy, color, 0.01
    sun.data.use_shadow = shadow
    sun.location = Vector(direction) * 3.0
    look_at(sun, (0.0, 0.0, 0.0))
    scene.collection.objects.link(sun)
    return sun


def add_area_light(
    scene: bpy.types.Scene, place: Point, power: float, size: float, color: Point = (1.0, 1.0, 1.0)
) -> bpy.types.Object:
    """A square light that looks at the origin; power in watts."""
    light = bpy.data.objects.new("Area Light", bpy.data.lights.new("Area Light", "AREA"))
    light.data.energy, light.data.size, light.data.color = power, size, color
    light.location = place
    look_at(light, (0.0, 0.0, 0.0))
    scene.collection.objects.link(light)
    return light


def set_world(scene: bpy.types.Scene, color: Point, strength: float = 1.0) -> None:
    world = bpy.data.worlds.new("Stormfield World")
    scene.world = world
    if world.node_tree is None:  # before Blender 5 a world has no nodes until asked
        world.use_nodes = True
    world.cycles.sampling_method = "NONE"  # a dark sky lights nothing: every sample goes to the lamps
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


def set_cycles(scene: bpy.types.Scene, samples: int, bounces: int = 0, denoise: bool = False) -> None:
    """Cycles with a fixed number of samples. No bounces: direct light only, as for a body in space."""
    scene.render.engine = "CYCLES"  # type: ignore[assignment]
    scene.render.use_persistent_data = True
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_denoising = samples, bounces, denoise
    cycles.use_adaptive_sampling, cycles.seed = False, 0
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"


def add_studio(scene: bpy.types.Scene, width: int, height: int, samples: int = 12) -> None:
    """A dark studio for an object of about unit size at the origin, seen along +y: key, fill and rim light."""
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.fps = 24
    scene.view_settings.view_transform = "AgX"
    set_cycles(scene, samples, bounces=2, denoise=True)
    set_world(scene, (0.012, 0.015, 0.02))
    add_area_light(scene, (2.6, -4.0, 3.2), 420.0, 2.0, (1.0, 0.95, 0.88))
    add_area_light(scene, (-4.5, -2.5, 0.5), 110.0, 3.0, (0.65, 0.8, 1.0))
    add_area_light(scene, (-1.5, 4.5, 3.0), 420.0, 2.0, (0.8, 0.9, 1.0))
    add_area_light(scene, (3.5, 3.0, 0.5), 160.0, 1.5, (1.0, 0.7, 0.5))


def add_field(obj: bpy.types.Object, scene: bpy.types.Scene, samples: int, period: int, even_speed: float) -> None:
    """Turn the object into one with a field: λ keyed over the scene's frames, solve and bake settings."""
    settings = obj.stormfield
    settings.enabled = True
    settings.solve.samples, settings.solve.even_speed = samples, even_speed
    settings.bake.period = period
    key_lambda_over_scene(scene, obj)
