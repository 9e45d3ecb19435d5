# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines → a Curves object with radius and named attributes, ready for hair and curve shading and Geometry Nodes.

    lines = make_curves("Streamlines", polylines, {"speed": speeds}, radius=0.01, parent=obj)

A Curves object is known by its role (the name given here) and its parent: making the same curves again replaces the
data and keeps object, modifiers, materials and whatever the artist did to them, also when it was renamed. It follows
the surface of its parent that is seen.
"""

from collections.abc import Mapping, Sequence

import bpy
import numpy as np

from ..read.results import ROLE, find_curves
from .following import follow_surface

#: Attributes that belong to every Curves object and are never taken for old ones.
OWN = frozenset({"position", "radius", "cyclic", "curve_type"})
#: Attribute types by element type and width: (name, property of one element, NumPy type of its numbers).
TYPES = {
    ("f", 1): ("FLOAT", "value", np.float32),
    ("f", 3): ("FLOAT_VECTOR", "vector", np.float32),
    ("f", 4): ("FLOAT_COLOR", "color", np.float32),
    ("i", 1): ("INT", "value", np.int32),
    ("b", 1): ("BOOLEAN", "value", np.bool_),
}


def make_curves(
    name: str,
    curves: Sequence[np.ndarray],
    attributes: Mapping[str, Sequence[np.ndarray]] | None = None,
    radius: float | Sequence[np.ndarray] = 0.01,
    *,
    cyclic: Sequence[bool] | np.ndarray | None = None,
    curve_attributes: Mapping[str, np.ndarray] | None = None,
    parent: bpy.types.Object | None = None,
    collection: bpy.types.Collection | None = None,
    material: bpy.types.Material | None = None,
) -> bpy.types.Object:
    """The Curves object of role `name` under `parent`, made or updated in place.

    curves: per curve (k, 3) points in the parent's object space (world space without one); cyclic curves do not repeat
    their first point. attributes: per name and curve (k,), (k, 3) or (k, 4) numbers, one per point; curve_attributes:
    one per curve. radius: mesh units, one number or (k,) per curve. New objects get `material`, and are linked to
    `collection`, else to the parent's collections, else to the scene's. Raises ValueError for an object in another mode
    than Object Mode.
    """
    obj = find_curves(name, parent)
    if obj is None:
        obj = _new_object(name, parent, collection)
        if material is not None:
            obj.data.materials.append(material)
    elif obj.mode != "OBJECT":
        raise ValueError(f"'{obj.name}' is being edited; leave {obj.mode.replace('_', ' ').title()} Mode first")
    data = obj.data
    sizes = [len(points) for points in curves]
    if len(data.curves):
        data.remove_curves()
    if sizes:
        data.add_curves(sizes)
        data.set_types(type="POLY")
    points = _joined(curves, (0, 3))
    radii = np.full(len(points), radius) if np.isscalar(radius) else _joined(radius, (0,))
    per_point = {key: _joined(values, (0,)) for key, values in (attributes or {}).items()}
    per_curve = {key: np.asarray(values) for key, values in (curve_attributes or {}).items()}
    _remove_others(data, per_point.keys() | per_curve.keys() | OWN)
    if sizes:
        _write(data, "position", "POINT", points)
        _write(data, "radius", "POINT", radii)
        _write(data, "cyclic", "CURVE", np.zeros(len(sizes), bool) if cyclic is None else np.asarray(cyclic, bool))
    for domain, columns in (("POINT", per_point), ("CURVE", per_curve)):
        for key, values in columns.items():
            _write(data, key, domain, values)
    data.update_tag()
    obj.update_tag()
    follow_surface(obj)
    return obj


def remove_curves(name: str, parent: bpy.types.Object | None = None) -> bool:
    """Remove that object and its data; whether there was one."""
    obj = find_curves(name, parent)
    if obj is None:
        return False
    data = obj.data
    bpy.data.objects.remove(obj)
    if data.users == 0:
        bpy.data.hair_curves.remove(data)
    return True


def _new_object(
    name: str, parent: bpy.types.Object | None, collection: bpy.types.Collection | None
) -> bpy.types.Object:
    full_name = f"{parent.name} {name}" if parent else name
    obj = bpy.data.objects.new(full_name, bpy.data.hair_curves.new(full_name))
    obj[ROLE] = name
    obj.parent = parent
    if collection is not None:
        targets = [collection]
    else:
        targets = list(parent.users_collection if parent else ()) or [bpy.context.scene.collection]
    for target in targets:
        target.objects.link(obj)
    return obj


def _joined(arrays: Sequence[np.ndarray], empty: tuple[int, ...]) -> np.ndarray:
    return np.concatenate([np.asarray(array) for array in arrays]) if len(arrays) else np.empty(empty)


def _remove_others(data: bpy.types.Curves, kept: frozenset[str]) -> None:
    """Attributes of an earlier run, so that no stale numbers stay. Hidden ones (with a dot) are Blender's."""
    for key in [attribute.name for attribute in data.attributes]:
        if key not in kept and not key.startswith("."):
            data.attributes.remove(data.attributes[key])


def _write(data: bpy.types.Curves, key: str, domain: str, values: np.ndarray) -> None:
    kind = {"u": "i"}.get(values.dtype.kind, values.dtype.kind)
    data_type, element, number = TYPES[kind, 1 if values.ndim == 1 else values.shape[1]]
    attribute = data.attributes.get(key)
    if attribute is not None and (attribute.data_type, attribute.domain) != (data_type, domain):
        data.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = data.attributes.new(key, data_type, domain)
    if attribute is None:
        raise ValueError(f"Blender keeps the name '{key}' to itself; give the attribute another one")
    if len(values) != len(attribute.data):
        raise ValueError(f"attribute '{key}' has {len(values)} values for {len(attribute.data)} elements")
    if len(values):
        attribute.data.foreach_set(element, np.ascontiguousarray(values, number).ravel())
