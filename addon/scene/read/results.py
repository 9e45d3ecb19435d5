# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects of an analysis, found by their role and parent, and what they hold.

A role is the name that an object was made under; objects keep it when they are renamed.
"""

import bpy
import numpy as np

from ...analysis.colours import KIND_COLOURS

#: Custom property that holds an object's role.
ROLE = "stormfield_role"
#: Roles of the objects of an analysis.
SEPARATRICES, ORBITS, POINTS = "Separatrices", "Periodic Orbits", "Entities"
PATHS, EVENTS = "Singularity Paths", "Bifurcations"
#: Kinds of bifurcations, and all kinds by their number in the attribute `kind`.
EVENT_KINDS = frozenset({"creation", "annihilation", "hopf"})
KINDS = (*KIND_COLOURS, "creation", "annihilation", "hopf")


def kind_number(kind: str) -> int:
    return KINDS.index(kind) if kind in KINDS else KINDS.index("other")


def find_curves(role: str, parent: bpy.types.Object | None = None) -> bpy.types.Object | None:
    """The Curves object of this role under `parent`, if it is still in the file."""
    made = (obj for obj in bpy.data.objects if obj.type == "CURVES" and obj.get(ROLE) == role)
    return next((obj for obj in made if obj.parent == parent), None)


def find_points(role: str, obj: bpy.types.Object) -> bpy.types.Object | None:
    made = (other for other in obj.children if other.type == "MESH" and other.get(ROLE) == role)
    return next(made, None)


def read_curves(obj: bpy.types.Object, role: str) -> list[np.ndarray]:
    """The points of every curve of a role, (k, 3) each, as the file holds them; none where there is no such object."""
    made = find_curves(role, obj)
    if made is None or not len(made.data.curves):
        return []
    data = made.data
    points = _read(data.attributes["position"], "vector", 3)
    sizes = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("points_length", sizes)
    return np.split(points, np.cumsum(sizes)[:-1])


def read_attribute(obj: bpy.types.Object, role: str, name: str) -> np.ndarray:
    """One attribute of a role's curves or of their points, flat; empty where there is none."""
    made = find_curves(role, obj)
    attribute = made.data.attributes.get(name) if made is not None else None
    if attribute is None:
        return np.zeros(0, np.int32)
    if attribute.data_type == "FLOAT_COLOR":
        return _read(attribute, "color", 4)
    return _read(attribute, "value", 1, np.int32 if attribute.data_type == "INT" else np.float32)


def _read(attribute, key: str, width: int, number=np.float32) -> np.ndarray:
    values = np.empty(len(attribute.data) * width, number)
    attribute.data.foreach_get(key, values)
    return values.reshape(-1, width) if width > 1 else values
