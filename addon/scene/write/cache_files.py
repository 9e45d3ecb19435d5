# SPDX-License-Identifier: GPL-3.0-or-later
"""Cache files (Blender's data-blocks that read a cache): each belongs to one object, and follows the λ of that object.

A copied object shares the cache files of the first, as it shares all data. They are parted as soon as that is seen:
the same cache on disk, read by a data-block of its own.
"""

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ... import compat
from ...cache.layout import TIME_CODES_PER_LAMBDA
from ..read.attached import NAMES, OVER_LAMBDA, SORT, file_of, modifiers_of
from ..read.cache_paths import RECORDS
from ..read.folders import relative
from ..read.lambda_seen import time_stretch
from .fcurves import set_points

#: Bytes of a path in Blender, without the one that ends it.
LONGEST_PATH = 1023


def new(stage: Path) -> bpy.types.CacheFile:
    before = set(bpy.data.cache_files)
    bpy.ops.cachefile.open(filepath=str(stage), relative_path=False)
    # Library overrides may be brought up to date by the way, which makes cache files of their own.
    made = set(bpy.data.cache_files) - before
    cache_file = next(file for file in made if file.library is None and file.override_library is None)
    cache_file.user_clear()  # the operator counts a button as user that is not there without a window
    return cache_file


def set_path(cache_file: bpy.types.CacheFile, stage: Path) -> None:
    """The file it reads, relative to the open file where that is possible."""
    text = relative(stage, bpy.data.filepath)
    if cache_file.filepath != text:
        # Blender writes the whole buffer: the end of a longer path would go on naming the old cache (cache_use.py).
        cache_file.filepath = "/" * LONGEST_PATH
        cache_file.filepath = text


def follow_lambda(obj: bpy.types.Object, cache_file: bpy.types.CacheFile) -> None:
    """The cache shows the λ of `obj`, by a driver and nothing else: with an F-curve beside it Blender sometimes shows
    the value of an earlier frame."""
    cache_file.override_frame = True
    remove_curve(cache_file)
    cache_file.driver_remove("frame")
    driver = cache_file.driver_add("frame").driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.name = "lam"
    variable.targets[0].id = obj
    variable.targets[0].data_path = "stormfield.lam"
    driver.expression = f"lam * {TIME_CODES_PER_LAMBDA:.0f}"


def follow_frames(cache_file: bpy.types.CacheFile, scene: bpy.types.Scene) -> None:
    """The cache shows the scene's frame, of which Blender's time stretching makes another time."""
    remove_curve(cache_file)
    stretch = time_stretch(scene)
    cache_file.override_frame = stretch != 1.0
    if cache_file.override_frame:
        cache_file.keyframe_insert("frame", frame=0.0)
        curve: Any = compat.find_fcurve(cache_file, "frame")
        set_points(curve, np.array([[0.0, 0.0], [stretch, 1.0]]))
        curve.extrapolation = "LINEAR"


def remove_curve(cache_file: bpy.types.CacheFile) -> None:
    """Take away the F-curve of the frame it shows."""
    old = compat.find_fcurve(cache_file, "frame")
    if old is not None:
        compat.remove_fcurve(cache_file, old)


def followed(cache_file: bpy.types.CacheFile) -> bpy.types.Object | None:
    """The object whose λ it follows."""
    animation = cache_file.animation_data
    for curve in animation.drivers if animation else ():
        if curve.data_path == "frame" and curve.driver.variables:
            target = curve.driver.variables[0].targets[0]
            leader: Any = target.id
            return leader if target.data_path == "stormfield.lam" else None
    return None


def is_own(obj: bpy.types.Object, cache_file: bpy.types.CacheFile) -> bool:
    """Whether the cache file that a modifier of `obj` reads belongs to this object: of those that share it, to the one
    whose λ it follows, else to the first that was made."""
    if cache_file.library is not None or cache_file.override_library is not None:
        return False
    sharing = _users(cache_file)
    leader = followed(cache_file)
    return obj == (leader if leader in sharing else min(sharing, key=lambda other: other.session_uid, default=obj))


def part_copies() -> list[bpy.types.Object]:
    """Give every object of this file the cache files of its own that it lacks; which objects got some."""
    parted = [obj for obj in bpy.data.objects if _has_field(obj) and _part(obj)]
    for obj in parted:
        obj.stormfield.cache_name = ""
        for name in RECORDS.values():
            setattr(obj.stormfield.bake, name, "")
    return parted


def _part(obj: bpy.types.Object) -> bool:
    shared = False
    for sort in NAMES:
        for modifier in modifiers_of(obj, sort):
            if modifier.cache_file is None:
                continue
            if not is_own(obj, modifier.cache_file):
                modifier.cache_file = _copy(modifier.cache_file, sort)
                shared = True
            if sort in OVER_LAMBDA and followed(modifier.cache_file) != obj:
                follow_lambda(obj, modifier.cache_file)
    return shared


def _has_field(obj: bpy.types.Object) -> bool:
    return obj.type == "MESH" and obj.library is None and obj.stormfield.enabled


def _copy(cache_file: bpy.types.CacheFile, sort: str) -> bpy.types.CacheFile:
    path = file_of(cache_file)
    copy: Any = cache_file.copy()
    copy.animation_data_clear()
    copy.user_clear()
    copy[SORT] = sort
    set_path(copy, path)
    return copy


def _users(cache_file: bpy.types.CacheFile) -> list[bpy.types.Object]:
    """Objects of this file with a modifier that reads it."""
    return [
        obj
        for obj in bpy.data.objects
        if obj.type == "MESH"
        and any(m.type == "MESH_SEQUENCE_CACHE" and m.cache_file == cache_file for m in obj.modifiers)
    ]
