# SPDX-License-Identifier: GPL-3.0-or-later
"""Two storms of a gas giant drift together and merge (thesis figure 11.8).

The planet is a unit sphere that turns about z. Jets are streamlines along circles of latitude, all eastward but of
different speed, so that the stream function falls from pole to pole and bands follow its level sets. The storms are
counter-clockwise vortices (anticyclones of the south) on singularity paths: two that wind around each other and end at
one point at λ = MERGE, and one that starts there. Angles in radians, speeds in radians per second.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy

from ..shading import shared_material
from . import parts

MERGE = 0.6  # λ at which two storms become one


@dataclass(frozen=True)
class Jet:
    latitude: float  # degrees
    speed: float  # angular speed about the axis, radians per second; eastward
    half_width: float = 0.05


@dataclass(frozen=True)
class Storm:
    name: str
    places: tuple[tuple[float, float], ...]  # (longitude, latitude) in degrees
    lam: tuple[float, float]
    spin: float  # angular speed of the core, radians per second
    radius: float


JETS = (
    Jet(68, 0.10), Jet(52, 0.20), Jet(38, 0.08), Jet(24, 0.22), Jet(10, 0.10), Jet(0, 0.16), Jet(-5, 0.05),
    Jet(-36, 0.25), Jet(-45, 0.09), Jet(-56, 0.2), Jet(-68, 0.1),
)  # fmt: skip
MEETING = (0.0, -20.0)


def _approach(bearing: float, distance: float, angle: float, steps: int = 25) -> tuple[tuple[float, float], ...]:
    """A path to the meeting place that starts at that bearing and distance (degrees) and winds by ``angle`` degrees."""
    places = []
    for step in range(steps):
        s = step / (steps - 1)
        left, direction = distance * (1.0 - s), math.radians(bearing + angle * s * s)
        latitude = MEETING[1] + left * math.sin(direction)
        places.append((MEETING[0] + left * math.cos(direction) / math.cos(math.radians(latitude)), latitude))
    return tuple(places)


STORMS = (
    Storm("Storm West", _approach(190.0, 17.0, 80.0), (0.0, MERGE), 2.1, 0.11),
    Storm("Storm East", _approach(10.0, 17.0, 80.0), (0.0, MERGE), 2.3, 0.095),
    Storm("Merged Storm", ((0.0, -20.0), (3.0, -20.0), (6.0, -20.5)), (MERGE, 1.0), 1.7, 0.125),
)


def on_sphere(longitude: float, latitude: float, radius: float = 1.0) -> tuple[float, float, float]:
    lon, lat = math.radians(longitude), math.radians(latitude)
    return (radius * math.cos(lat) * math.cos(lon), radius * math.cos(lat) * math.sin(lon), radius * math.sin(lat))


#: From where the storms are seen: (longitude, latitude).
SEEN_FROM = (6.0, -25.0)
PERIOD = 1.75  # seconds until a phase of the clouds starts anew


def build(context: bpy.types.Context, subdivisions: int = 7, frames: int = 84) -> bpy.types.Object:
    """The whole scene to render: planet, camera, light and render settings; returns the planet."""
    context.scene.frame_start, context.scene.frame_end = 1, frames
    context.scene.render.fps = 24
    planet = build_planet(context.scene, subdivisions)
    add_stage(context.scene)
    context.view_layer.objects.active = planet
    return planet


def build_planet(scene: bpy.types.Scene, subdivisions: int, place: parts.Point = (0.0, 0.0, 0.0)) -> bpy.types.Object:
    """The planet with its elements and material at a place, λ keyed over the scene's frames; all else is left alone.

    ``subdivisions`` is that of Blender's icosphere: 7 makes 41 k vertices, 6 a quarter of that."""
    planet = parts.add_icosphere(scene, "Gas Giant", subdivisions)
    parts.concentrate(planet.data, on_sphere(*MEETING), 2.2)
    planet.location = place
    _add_elements(scene, planet)
    period = max(2, round(PERIOD * scene.render.fps / scene.render.fps_base))
    parts.add_field(planet, scene, samples=60, period=period, even_speed=0.0)
    planet.data.materials.append(shared_material("storm_clouds"))
    return planet


def _add_elements(scene: bpy.types.Scene, planet: bpy.types.Object) -> None:
    collection = parts.element_collection(scene, planet)
    size = math.sqrt(4.0 * math.pi)  # of the unit sphere: the unit of speeds is sizes per second
    for jet in JETS:
        circle = [on_sphere(longitude, jet.latitude) for longitude in range(360)]
        source = parts.curve_object(f"Jet {jet.latitude:+d}°", circle, collection, planet, cyclic=True)
        speed = jet.speed * math.cos(math.radians(jet.latitude)) / size
        parts.add_element(planet, source, type="streamline", strength=speed, radius=jet.half_width)
    for storm in STORMS:
        path = [on_sphere(*place) for place in storm.places]
        source = parts.curve_object(storm.name, path, collection, planet)
        parts.add_element(
            planet, source, type="singular", kind="vortex_ccw", lam_start=storm.lam[0], lam_end=storm.lam[1],
            strength=storm.spin * storm.radius / size, radius=storm.radius,
        )  # fmt: skip


def add_stage(scene: bpy.types.Scene) -> None:
    """Camera, sun, world and render settings for a planet at the origin."""
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 960, 540, 100
    scene.view_settings.view_transform = "Standard"
    parts.set_cycles(scene, samples=3)
    parts.set_world(scene, (0.0005, 0.0007, 0.0012))
    parts.add_sun(scene, on_sphere(30.0, 8.0), energy=3.5, color=(1.0, 0.97, 0.92), shadow=False)
    parts.add_camera(scene, on_sphere(*SEEN_FROM, 2.62), on_sphere(1.5, -19.5), lens=50.0)
