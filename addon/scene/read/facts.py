# SPDX-License-Identifier: GPL-3.0-or-later
"""What a field depends on in the scene, as digests: settings, the control points of curves, keys."""

import hashlib
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any

import bpy
import numpy as np

from ... import compat

#: Settings that change no field.
IDLE = frozenset({"rna_type", "name", "enabled", "solved", "keep_solver", "status", "reason"})


def values_of(group: bpy.types.PropertyGroup, without: frozenset[str] = frozenset()) -> tuple[object, ...]:
    """All numbers, words and switches of a group of settings, in the order of their names in the program."""
    return tuple(_plain(getattr(group, name)) for name in names_of(group) if name not in without)


def _plain(value: Any) -> object:
    """Vectors as tuples."""
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def names_of(group: bpy.types.PropertyGroup) -> tuple[str, ...]:
    return _names_of(type(group))


@cache
def _names_of(kind: type[bpy.types.PropertyGroup]) -> tuple[str, ...]:
    properties = kind.bl_rna.properties
    return tuple(
        p.identifier for p in properties if p.identifier not in IDLE and p.type not in {"POINTER", "COLLECTION"}
    )


def shape_of(source: bpy.types.Object) -> Iterator[object]:
    """The control points of a source in its own space."""
    yield source.type, [(modifier.name, modifier.show_viewport) for modifier in source.modifiers]
    data = source.data
    if source.type == "CURVE":
        for spline in data.splines:
            yield spline.type, spline.use_cyclic_u, spline.order_u, spline.resolution_u
            if spline.type == "BEZIER":
                yield from (_points(spline.bezier_points, name) for name in ("co", "handle_left", "handle_right"))
            else:
                yield _points(spline.points, "co", 4)
    elif source.type == "CURVES":
        yield _points(data.attributes["position"].data, "vector") if len(data.points) else ()
        yield [curve.points_length for curve in data.curves]
    elif source.type == "MESH":
        yield _points(data.vertices, "co")
        edges = np.empty(len(data.edges) * 2, np.int32)
        data.edges.foreach_get("vertices", edges)
        yield edges
    elif source.type == "GREASEPENCIL":
        for layer in data.layers:
            frame = layer.current_frame()
            yield layer.hide, [tuple(row) for row in layer.matrix_local]
            for stroke in frame.drawing.strokes if frame else ():
                yield [tuple(point.position) for point in stroke.points]


def _points(collection, name: str, width: int = 3) -> np.ndarray:
    values = np.empty(len(collection) * width, np.float32)
    collection.foreach_get(name, values)
    return values


def all_keys(source: bpy.types.Object) -> Iterator[object]:
    """Keys and drivers that move the source, its parents or its shape."""
    holder: bpy.types.Object | None = source
    while holder is not None:
        yield from keys_of(holder)
        holder = holder.parent
    if source.data is not None:
        yield from keys_of(source.data)


def keys_of(owner: bpy.types.ID) -> Iterator[object]:
    if getattr(owner, "animation_data", None) is None:
        return
    for curve in compat.fcurves(owner):
        keys = np.empty(len(curve.keyframe_points) * 2, np.float32)
        curve.keyframe_points.foreach_get("co", keys)
        yield curve.data_path, curve.array_index
        yield keys
    for driver in owner.animation_data.drivers:
        yield driver.data_path, driver.driver.expression


def element_keys(obj: bpy.types.Object, element) -> Iterator[tuple[str, object]]:
    """Name and keys, or expression, of each animated setting of an element."""
    if obj.animation_data is None:
        return
    path = f"{element.path_from_id()}."
    for curve in compat.fcurves(obj):
        if curve.data_path.startswith(path):
            yield curve.data_path.removeprefix(path), [tuple(key.co) for key in curve.keyframe_points]
    for driver in obj.animation_data.drivers:
        if driver.data_path.startswith(path):
            yield driver.data_path.removeprefix(path), driver.driver.expression


def digest(*parts: object) -> str:
    found = hashlib.blake2b(digest_size=12)
    for part in _flat(parts):
        found.update(part)
    return found.hexdigest()


def _flat(parts: Iterable[object]) -> Iterator[bytes]:
    for part in parts:
        yield part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
        yield b"|"
