# SPDX-License-Identifier: GPL-3.0-or-later
"""λ's animation, copied onto the cache file when a file is saved: it plays the same where the add-on is not installed.

With the add-on a driver sets the cache file's frame from λ. Without it Blender does not know the property λ, and where
a driver that is invalid stands beside an F-curve, Blender's threads sometimes show an earlier frame: while the file is
written an F-curve takes the driver's place. Keys are copied, with their modifiers; a driver of λ that needs no add-on
is copied itself; all else is sampled at each frame.
"""

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ... import compat
from ...cache.layout import TIME_CODES_PER_LAMBDA as TIME_CODES
from ..read.attached import FRAMES, OVER_LAMBDA, find_modifier, modifiers_of
from ..read.lambda_seen import lambda_alone, lambda_at_frames, time_stretch
from ..read.lambda_source import driver_of, is_scripted, plain_keys, why_sampled
from .cache_files import follow_frames, follow_lambda, remove_curve
from .fcurves import copy_scaled, is_multiple, scale, set_points
from .scene_flows import scene_of

#: λ may lie this far from the straight line between two frames before frames in between are sampled as well.
BEND = 1e-3
#: Where those are.
BETWEEN = (0.25, 0.5, 0.75)


@dataclass
class Mirrored:
    """What a file has got for Blenders without the add-on, and what is to be put back once it is written."""

    remarks: list[str] = field(default_factory=list)
    _written: list[tuple[bpy.types.Object, bpy.types.CacheFile]] = field(default_factory=list)

    def add(self, obj: bpy.types.Object, cache_file: bpy.types.CacheFile) -> None:
        self._written.append((obj, cache_file))

    def release(self) -> None:
        """Take the drivers away that need the add-on, once nothing is evaluated any more: updates bring them back."""
        for obj, cache_file in self._written:
            driver = driver_of(obj)
            if driver is not None and _needs_no_addon(driver):
                _drive(cache_file, driver)
            else:
                cache_file.driver_remove("frame")

    def undo(self) -> None:
        """With the add-on cache files follow λ itself."""
        for obj, cache_file in self._written:
            follow_lambda(obj, cache_file)


def mirror_all(context: bpy.types.Context) -> Mirrored:
    mirrored = Mirrored()
    for obj in list(bpy.data.objects):
        if obj.type == "MESH" and obj.is_editable and obj.stormfield.enabled:
            _mirror(context, obj, mirrored)
            for flow in modifiers_of(obj, FRAMES):
                if flow.cache_file is not None and flow.cache_file.is_editable:
                    follow_frames(flow.cache_file, scene_of(flow) or context.scene)
    mirrored.release()
    return mirrored


def _mirror(context: bpy.types.Context, obj: bpy.types.Object, mirrored: Mirrored) -> None:
    files = [modifier.cache_file for sort in OVER_LAMBDA if (modifier := find_modifier(obj, sort)) is not None]
    files = [file for file in files if file is not None and file.is_editable]
    for file in files:
        remove_curve(file)
        mirrored.add(obj, file)
    driver, curve = driver_of(obj), plain_keys(obj)
    if not files or (driver is not None and _needs_no_addon(driver)):
        return
    if curve is None or not all(_copied(file, curve) for file in files):
        why = why_sampled(obj) or ("modifiers of its keys" if curve is not None else "")
        points = _sampled(context, obj) if why else np.array([[0.0, obj.stormfield.lam * TIME_CODES]])
        for file in files:
            set_points(_curve(file), points)
        if why:
            mirrored.remarks.append(f"λ of '{obj.name}' comes from {why}: without the add-on it is as sampled now")


def _needs_no_addon(curve: bpy.types.FCurve) -> bool:
    """Whether a driver of λ works on another data-block, where nobody knows Stormfield's settings."""
    targets = [target for variable in curve.driver.variables for target in variable.targets]
    return not curve.driver.use_self and not any("stormfield" in target.data_path for target in targets)


def _drive(file: bpy.types.CacheFile, driver: bpy.types.FCurve) -> None:
    file.driver_remove("frame")
    animation: Any = file.animation_data_create()
    curve = animation.drivers.from_existing(src_driver=driver)
    curve.data_path = "frame"
    scale(curve, TIME_CODES)


def _copied(file: bpy.types.CacheFile, curve: bpy.types.FCurve) -> bool:
    """Copies plain keys; whether the copy is the same. A curve without keys, of modifiers alone, gets one that counts
    for nothing."""
    for time in [key.co.x for key in curve.keyframe_points] or [0.0]:
        file.keyframe_insert("frame", frame=time)
    mine = _curve(file)
    if not len(curve.keyframe_points):
        mine.keyframe_points.clear()
    copy_scaled(mine, curve, TIME_CODES)
    return is_multiple(mine, curve, TIME_CODES)


def _curve(file: bpy.types.CacheFile) -> bpy.types.FCurve:
    found = compat.find_fcurve(file, "frame")
    if found is None:
        file.keyframe_insert("frame", frame=0.0)
        found = compat.find_fcurve(file, "frame")
    assert found is not None
    while len(found.modifiers):
        found.modifiers.remove(found.modifiers[0])
    return found


def _sampled(context: bpy.types.Context, obj: bpy.types.Object) -> np.ndarray:
    """(n, 2) times of the animation and frames of the cache: at each frame of the scene, and between where λ bends."""
    scene = context.scene
    frames = [float(frame) for frame in range(scene.frame_start - 1, scene.frame_end + 2)]
    at_frames = lambda_at_frames if is_scripted() else lambda_alone
    values = at_frames(context, obj, frames)
    bent = np.flatnonzero(np.abs(np.diff(values, 2)) > BEND) + 1
    more = sorted({frames[index] + side + part for index in bent for side in (-1.0, 0.0) for part in BETWEEN})
    if more:
        values += at_frames(context, obj, more)
    points = np.column_stack([np.array(frames + more) * time_stretch(scene), np.array(values) * TIME_CODES])
    return points[np.argsort(points[:, 0])]
