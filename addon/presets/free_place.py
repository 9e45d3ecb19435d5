# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a new object stands free of all others."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

import bpy
import numpy as np
from mathutils import Vector

#: Most objects and instances that are looked at.
MAX_OBJECTS = 20_000
#: Distance that is kept, in radii.
GAP = 0.25


def free_place(context: bpy.types.Context, radius: float) -> Vector:
    """At the 3D cursor, or as little to its right (+x) as keeps a ball of that radius clear of all that is visible."""
    boxes = np.array(list(_boxes(context))).reshape(-1, 2, 3)
    place = np.array(context.scene.cursor.location)
    reach = (1.0 + GAP) * radius
    while True:
        hit = np.all((boxes[:, 0] < place + reach) & (boxes[:, 1] > place - reach), axis=1)
        if not hit.any():
            return Vector(place)
        place[0] = np.nextafter(boxes[hit, 1, 0].max() + reach, np.inf)


def _boxes(context: bpy.types.Context) -> Iterable[tuple[np.ndarray, np.ndarray]]:
    """The lowest and the highest corner in the world of everything visible that has an extent."""
    for instance in islice(context.evaluated_depsgraph_get().object_instances, MAX_OBJECTS):
        obj = instance.object
        if obj.type in {"EMPTY", "CAMERA", "LIGHT", "LIGHT_PROBE", "SPEAKER"}:
            continue
        matrix = np.array(instance.matrix_world)
        corners = np.array(obj.bound_box) @ matrix[:3, :3].T + matrix[:3, 3]
        low, high = corners.min(axis=0), corners.max(axis=0)
        if np.isfinite(high - low).all() and (high > low).any():
            yield low, high
