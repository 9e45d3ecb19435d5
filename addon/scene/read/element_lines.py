# SPDX-License-Identifier: GPL-3.0-or-later
"""Where elements are, for drawing them: as read/curves.py reads them for a solve, but from the control points alone.

Draw handlers must not evaluate or make anything. Modifiers of a curve are therefore not seen here; the solve sees them.
"""

from collections.abc import Iterator

import bpy
import numpy as np

#: Points between two control points of a curve.
FINE = 12


def element_lines(obj: bpy.types.Object, source: bpy.types.Object) -> list[np.ndarray]:
    """Per stroke, spline or empty (n, 3) float64, in the space of the mesh `obj`. An empty is two points, the second
    one unit along its X axis."""
    matrix = np.array(obj.matrix_world.inverted_safe() @ source.matrix_world)
    readers = {"CURVE": _splines, "CURVES": _hair, "MESH": _edges, "EMPTY": _empty}
    reader = readers.get(source.type)
    lines = list(reader(source)) if reader is not None else []
    return [line @ matrix[:3, :3].T + matrix[:3, 3] for line in lines if len(line)]


def _empty(_source: bpy.types.Object) -> Iterator[np.ndarray]:
    yield np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])


def _splines(source: bpy.types.Object) -> Iterator[np.ndarray]:
    for spline in source.data.splines:
        if spline.type == "BEZIER":
            points, left, right = (_read(spline.bezier_points, name) for name in ("co", "handle_left", "handle_right"))
            yield _bezier(points, left, right, spline.use_cyclic_u)
            continue
        points = _read(spline.points, "co", 4)[:, :3]
        if spline.type == "NURBS" and len(points) > 2:
            yield nurbs(points, spline.order_u, spline.use_cyclic_u, spline.use_endpoint_u)
        else:
            yield np.r_[points, points[:1]] if spline.use_cyclic_u else points


def _bezier(points: np.ndarray, left: np.ndarray, right: np.ndarray, cyclic: bool) -> np.ndarray:
    if cyclic:
        points, left, right = (np.r_[array, array[:1]] for array in (points, left, right))
    if len(points) < 2:
        return points
    t = np.linspace(0.0, 1.0, FINE, endpoint=False)[None, :, None]
    a, b, c, d = (array[:, None] for array in (points[:-1], right[:-1], left[1:], points[1:]))
    curve = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return np.r_[curve.reshape(-1, 3), points[-1:]]


def nurbs(points: np.ndarray, order: int, cyclic: bool, endpoint: bool) -> np.ndarray:
    """B-spline with even knots, through its ends where `endpoint` says so (Cox and de Boor); weights count as 1."""
    order = min(order, len(points))
    if cyclic:
        points = np.r_[points, points[: order - 1]]
    count = len(points)
    knots = np.arange(count + order, dtype=float)
    if endpoint and not cyclic:
        knots = np.clip(knots, order - 1, count)
    first, last = knots[order - 1], knots[count]
    t = np.linspace(first, last, FINE * (count - order + 1) + 1)
    t[-1] = np.nextafter(last, first)
    basis = ((knots[:-1] <= t[:, None]) & (t[:, None] < knots[1:])).astype(float)
    for k in range(2, order + 1):
        spans = knots[k - 1 :] - knots[: -k + 1]  # of each basis function of order k - 1
        share = np.where(spans > 0, 1.0 / np.where(spans > 0, spans, 1.0), 0.0)
        rising = (t[:, None] - knots[: -k + 1]) * share * basis
        falling = (knots[k - 1 :] - t[:, None]) * share * basis
        basis = rising[:, :-1] + falling[:, 1:]
    return basis @ points


def _hair(source: bpy.types.Object) -> Iterator[np.ndarray]:
    data = source.data
    if not len(data.points):
        return
    points = _read(data.attributes["position"].data, "vector")
    sizes = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("points_length", sizes)
    yield from np.split(points, np.cumsum(sizes)[:-1])


def _edges(source: bpy.types.Object) -> Iterator[np.ndarray]:
    """Each edge by itself: enough to draw them."""
    points = _read(source.data.vertices, "co")
    for edge in source.data.edges:
        yield points[list(edge.vertices)]


def _read(collection, name: str, width: int = 3) -> np.ndarray:
    values = np.empty(len(collection) * width, np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float64)
