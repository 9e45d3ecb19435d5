# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of one curve → storms that merge: two that end in one point at one λ, and one that goes on from there.

made = split_into_merge(obj, element)       # the elements, or why the strokes make no merge
"""

from __future__ import annotations

from itertools import product
from typing import Any

import bpy
from mathutils import Vector

from .elements import add_element

#: Custom property of a curve whose strokes shall merge.
MARK = "stormfield_merge"
#: λ at which the storms meet.
MEETING = 0.6


def why_not(curve: bpy.types.Object) -> str:
    """Why the strokes of a curve make no merge, and the cure; empty when they do."""
    strokes = len(curve.data.splines)
    if strokes not in (2, 3):
        return (
            f"A merge needs two strokes whose ends meet, and at most one that goes on from there; there are {strokes}"
        )
    if any(len(_points(spline)) < 2 for spline in curve.data.splines):
        return "A stroke of a merge is one point: draw it longer"
    return ""


def split_into_merge(obj: bpy.types.Object, element: Any) -> list[Any]:
    """The element's curve becomes one curve for each stroke. Two end at the meeting point at λ = MEETING, where they
    are nearest to each other; the third stroke, or a point where none is drawn, goes on from there. The order of the
    strokes and the direction in which each was drawn do not matter."""
    curve, settings = element.source, {name: getattr(element, name) for name in ("type", "kind", "strength", "radius")}
    for spline in curve.data.splines:  # Blender closes short strokes, whose ends are near on the screen
        spline.use_cyclic_u = False
    curves = [curve, *(_alone(curve, number) for number in range(1, len(curve.data.splines)))]
    for spline in curve.data.splines[1:]:
        curve.data.splines.remove(spline)
    first, second = _nearest_pair(curves)
    rest = [other for other in curves if other not in (first[0], second[0])]
    meeting = _on_surface(obj, 0.5 * (_end(*first) + _end(*second)))
    for came, at_begin in (first, second):
        _lead(came, at_begin, meeting, to_its_end=True)
    goes_on = rest[0] if rest else _point(obj, curve, meeting)
    if rest:
        at_begin = (_end(goes_on, True) - meeting).length <= (_end(goes_on, False) - meeting).length
        _lead(goes_on, at_begin, meeting, to_its_end=False)
    field = obj.stormfield
    field.elements.remove(field.elements.find(element.name))
    del curve[MARK]
    times = (
        ("Storm 1", first[0], 0.0, MEETING),
        ("Storm 2", second[0], 0.0, MEETING),
        ("Merged Storm", goes_on, MEETING, 1.0),
    )
    made = []
    for name, source, start, end in times:
        source.name = name
        made.append(add_element(obj, source, lam_start=start, lam_end=end, **settings).name)
    return [field.elements[name] for name in made]


def _points(spline: Any) -> Any:
    return spline.bezier_points if spline.type == "BEZIER" else spline.points


def _end(curve: bpy.types.Object, at_begin: bool) -> Vector:
    """An end of a curve's stroke in the space of the curve, which is that of the mesh."""
    return Vector(_points(curve.data.splines[0])[0 if at_begin else -1].co[:3])


def _alone(curve: bpy.types.Object, number: int) -> bpy.types.Object:
    """A copy of the curve with that stroke alone."""
    made: Any = curve.copy()
    made.data = curve.data.copy()
    for spline in [spline for i, spline in enumerate(made.data.splines) if i != number]:
        made.data.splines.remove(spline)
    for collection in curve.users_collection:
        collection.objects.link(made)
    return made


def _nearest_pair(curves: list[Any]) -> tuple[tuple[Any, bool], tuple[Any, bool]]:
    """The two curves, with the end of each, that come nearest to each other; the first two where a third meets both."""
    pairs = [(a, b) for i, a in enumerate(curves) for b in curves[i + 1 :]]
    both = [((a, x), (b, y)) for (a, b), x, y in product(pairs, (False, True), (False, True))]
    near = min((_end(*one) - _end(*other)).length for one, other in both)
    slack = max(2.0 * near, 0.05 * max((_end(c, True) - _end(c, False)).length for c in curves))
    return next(pair for pair in both if (_end(*pair[0]) - _end(*pair[1])).length <= slack)


def _lead(curve: bpy.types.Object, at_begin: bool, meeting: Vector, to_its_end: bool) -> None:
    """Turn the stroke so that the end that meets is its last point, or its first, and put that onto the meeting."""
    spline = curve.data.splines[0]
    points = _points(spline)
    point = points[0 if at_begin else -1]
    by = meeting - Vector(point.co[:3])
    if spline.type == "BEZIER":
        point.handle_left_type = point.handle_right_type = "FREE"
        point.handle_left, point.handle_right = point.handle_left + by, point.handle_right + by
        point.co = meeting
    else:
        point.co = (*meeting, 1.0)
    if at_begin == to_its_end:
        _turn_round(spline)
    curve.data.update_tag()


def _turn_round(spline: Any) -> None:
    points = _points(spline)
    if spline.type != "BEZIER":
        places = [tuple(point.co) for point in points]
        for point, place in zip(points, reversed(places), strict=True):
            point.co = place
        return
    known = [(p.co.copy(), p.handle_left.copy(), p.handle_right.copy()) for p in points]
    for point in points:
        point.handle_left_type = point.handle_right_type = "FREE"
    for point, (place, left, right) in zip(points, reversed(known), strict=True):
        point.co, point.handle_left, point.handle_right = place, right, left


def _on_surface(obj: bpy.types.Object, place: Vector) -> Vector:
    found, near, _normal, _face = obj.closest_point_on_mesh(place)
    return near if found else place


def _point(obj: bpy.types.Object, curve: bpy.types.Object, place: Vector) -> bpy.types.Object:
    """An empty in the space of the curve."""
    empty = bpy.data.objects.new("Merged Storm", None)
    empty.parent, empty.location = obj, place
    empty.empty_display_size = 0.05 * max(obj.dimensions[:], default=1.0)
    for collection in curve.users_collection:
        collection.objects.link(empty)
    return empty
