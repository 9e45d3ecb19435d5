# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of the mesh after a solve stay in sight: a cache that is of another mesh is turned off.

A Mesh Sequence Cache puts its own mesh in the place of one that has another number of vertices, and gives vectors to
the wrong vertices where only their order differs. Such modifiers are turned off for view and render, so that files
render the edited mesh without the add-on; they are turned on again when the mesh is the old one again (undo).
"""

import json
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...cache.field_cache import open_cache
from ..read.attached import LAMBDA, NAMES, TURN, find_modifier, modifiers_of
from ..read.mesh import read_mesh
from ..read.topology import CONNECTIVITY, SHAPE, Fit, fit, remember_mesh
from .scene_flows import drivers_of


def remember_attached(obj: bpy.types.Object, modifier: bpy.types.MeshSequenceCacheModifier, folder: Path) -> None:
    """A modifier shows the cache in that folder from now on: keep for which mesh it was made, and turn it on."""
    cache, mesh = open_cache(folder), read_mesh(obj)
    cache_file: Any = modifier.cache_file
    remember_mesh(cache_file, obj.data)
    if cache.manifest.plan.mesh.fingerprint != mesh.fingerprint():  # edited while it was made
        cache_file[SHAPE] = ""
        if not np.array_equal(cache.mesh.triangles, mesh.triangles):
            cache_file[CONNECTIVITY] = ""
    follow_mesh(obj)


def follow_mesh(obj: bpy.types.Object) -> None:
    """Turn off the caches that do not fit the object's mesh, and on again those that fit and were turned off here."""
    if obj.mode == "EDIT":  # Blender itself leaves the caches out
        return
    paused = _paused(obj)
    before = dict(paused)
    known = {}
    for name in (*NAMES, TURN):
        for number, modifier in enumerate(modifiers_of(obj, name)):
            known[name if number == 0 else f"{name} {number + 1}"] = modifier
    for name, modifier in known.items():
        cache_file = _cache_file(obj, LAMBDA) if name == TURN else modifier.cache_file
        if cache_file is None:
            paused.pop(name, None)
        elif fit(cache_file, obj.data) is Fit.OTHER:
            drivers = [curve for curve in drivers_of(obj, modifier) if not curve.mute]
            if drivers or modifier.show_viewport or modifier.show_render:
                paused[name] = [modifier.show_viewport, modifier.show_render]
                for curve in drivers:
                    curve.mute = True
                modifier.show_viewport = modifier.show_render = False
        elif name in paused:
            modifier.show_viewport, modifier.show_render = paused.pop(name)
            for curve in drivers_of(obj, modifier):
                curve.mute = False
    paused = {name: switches for name, switches in paused.items() if name in known}
    if paused != before:
        obj.stormfield.paused = json.dumps(paused) if paused else ""


def is_paused(obj: bpy.types.Object, name: str = LAMBDA) -> bool:
    """Whether the cache of that modifier is turned off because the mesh has changed."""
    return name in _paused(obj)


def _cache_file(obj: bpy.types.Object, name: str) -> bpy.types.CacheFile | None:
    modifier = find_modifier(obj, name)
    return None if modifier is None else modifier.cache_file


def _paused(obj: bpy.types.Object) -> dict[str, list[bool]]:
    """Modifier → its two switches as they were."""
    return json.loads(obj.stormfield.paused) if obj.stormfield.paused else {}
