# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's field → `MeshData` and `Design`: curves, empties and their animation in the mesh's object space.

Elements without animation are read at the current frame. Elements "from animation" are read at every frame between the
first and the last key of λ, and each place counts at that frame's λ; the scene is put back to its frame afterwards.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Matrix

from ...model.design import Design, Element, SolveSettings, Vector
from ...model.errors import InputError
from ...model.mesh_data import MeshData
from .curves import read_polylines, take_over_edits
from .edits import read_edits
from .lambda_seen import lambda_at_frames, lambda_frames, lambda_per_second
from .mesh import read_mesh
from .places import Placed, Places
from .seen_surface import SeenSurface

#: Most places that are read of an animated curve, which changes as a whole.
MAX_CURVES = 24
#: Types whose points lie at different λ: something moves from the first to the last.
MOVING = frozenset({"singular", "pathline"})


@dataclass(frozen=True)
class _Place:
    """Where one source object is at one λ."""

    lines: tuple[np.ndarray, ...]
    lam: float
    mirrored: bool = False  #: on a copy that a modifier of the field's object mirrors


def read_design(context: bpy.types.Context, obj: bpy.types.Object) -> tuple[MeshData, Design]:
    """Everything a solve needs. Raises InputError for an element without source, curve or keyframes."""
    mesh = read_mesh(obj)
    settings = obj.stormfield.solve
    enabled = [element for element in obj.stormfield.elements if element.enabled]
    for element in enabled:
        if element.source is None:
            raise InputError(f"Element '{element.name}' has no source; choose a curve or an empty, or turn it off")
        if element.source == obj:
            raise InputError(f"Element '{element.name}' has the field's own mesh as source; choose another object")
    edits = read_edits(context, obj)
    take_over_edits([element.source for element in enabled])
    elements: list[Element] = []
    with Places(context) as placed:
        surface = SeenSurface(placed, obj)
        moving = _moving_places(context, surface, [element for element in enabled if element.from_animation])
        mirrored = placed.matrix_world(obj).is_negative
        for element in enabled:
            places = next(moving) if element.from_animation else [_place(surface, element, element.lam_start)]
            made = _elements(element, places)
            exchanged = mirrored != places[0].mirrored
            elements.extend(each.mirrored() if exchanged else each for each in made)
    return mesh, Design(
        elements=tuple(elements),
        edits=edits,
        settings=SolveSettings(
            samples=settings.samples,
            lambda_weight=settings.lambda_weight,
            even_speed=settings.even_speed,
            tolerance=settings.tolerance,
            weld=settings.weld,
            edge=settings.edge if settings.solve_on == "DENSITY" else 0.0,
            lambda_per_second=lambda_per_second(context, obj),
        ),
    )


def _moving_places(context, surface: SeenSurface, elements) -> Iterator[list[_Place]]:
    """For each element its places in the order of λ; the frames are gone through once for all of them."""
    if not elements:
        return iter(())
    places: list[list[_Place]] = [[] for _ in elements]
    scene = context.scene
    before = scene.frame_current, scene.frame_subframe
    frames = lambda_frames(context, surface.obj)
    lams = lambda_at_frames(context, surface.obj, frames)
    try:
        highest = -1.0
        for frame, lam in zip(frames, lams, strict=True):
            if lam <= highest:  # λ is constant or decreases: its place is known
                continue
            highest = lam
            surface.places.at_frame(frame)
            for known, element in zip(places, elements, strict=True):
                known.append(_place(surface, element, lam))
    finally:
        surface.places.at_frame(*before)
    return iter(places)


def _place(surface: SeenSurface, element, lam: float) -> _Place:
    to_mesh = surface.places.matrix_world(surface.obj).inverted_safe()
    source = surface.places.of(element.source)
    if element.source.type == "EMPTY":
        arrow = _empty_line(source, to_mesh, element.radius)
        return _Place((surface.arrow_at_rest(arrow),), lam, surface.is_mirrored_at(arrow[:1]))
    lines = read_polylines(source.object, source.depsgraph, to_mesh)
    if not lines:
        raise InputError(
            f"Element '{element.name}': '{element.source.name}' has no curve yet; draw one, or turn it off"
        )
    carried = tuple(surface.line_at_rest(line) for line in lines)
    return _Place(carried, lam, surface.is_mirrored_at(lines[0]))


def _empty_line(source: Placed, to_mesh: Matrix, radius: float) -> np.ndarray:
    """The empty's place and a point one radius along its X axis, both in the mesh's space."""
    matrix: Matrix = to_mesh @ source.evaluated.matrix_world
    place = np.array(matrix.translation)
    axis = np.array(matrix)[:3, 0]
    axis /= np.linalg.norm(axis) or 1.0
    return np.array([place, place + radius * axis])


def _elements(element, places: list[_Place]) -> Iterator[Element]:
    """The plain elements that one element of the list stands for: one per spline, more where curves are animated."""
    base = _without_points(element)
    whole = (element.lam_start, element.lam_end)
    if element.source.type == "EMPTY" and base.type in MOVING:
        yield _on_empty(base, places, tuple(place.lam for place in places) if element.from_animation else whole)
    elif element.from_animation:
        yield from _on_animated_curves(base, places)
    else:
        yield from _on_curves(base, places[0].lines, whole)


def _without_points(element) -> Element:
    """What an element of the list says, besides where it is."""
    if element.lam_end < element.lam_start and not element.from_animation:
        raise InputError(
            f"Element '{element.name}' ends at λ {element.lam_end:g} before it starts at {element.lam_start:g}; "
            "exchange the two"
        )
    return Element(
        name=element.name,
        type=element.type,
        kind=element.kind,
        field=element.field,
        points=(),
        strength=element.strength,
        radius=element.radius,
        hard=element.hard,
        angle=element.angle,
    )


def _on_empty(base: Element, places: list[_Place], lam: tuple[float, ...]) -> Element:
    """A point, or one for each place where it moves; its X axis is that of the first place."""
    points = np.array([place.lines[0][0] for place in places])
    return replace(base, points=_rows(points), lam=lam, direction=_unit(places[0].lines[0]))


def _on_animated_curves(base: Element, places: list[_Place]) -> Iterator[Element]:
    """Curves that change as a whole: as they are at one λ, from there to the next."""
    chosen = places[:: -(-len(places) // MAX_CURVES)]
    for place, after in zip(chosen, [*chosen[1:], chosen[-1]], strict=True):
        yield from _on_curves(base, place.lines, (place.lam, after.lam), f" at λ {place.lam:.3f}")


def _on_curves(
    base: Element, lines: tuple[np.ndarray, ...], lam: tuple[float, float], suffix: str = ""
) -> Iterator[Element]:
    """One element per curve, numbered from the second on."""
    for number, line in enumerate(lines, start=1):
        name = (base.name if number == 1 else f"{base.name} ({number})") + suffix
        if base.type == "regular":
            yield replace(base, name=name, points=_rows(line[:1]), lam=lam, direction=_unit(line))
        elif base.type in MOVING and len(line) > 1:
            yield replace(base, name=name, points=_rows(line), lam=_lam_along(line, *lam))
        else:
            yield replace(base, name=name, points=_rows(line), lam=lam)


def _rows(points: np.ndarray) -> tuple[Vector, ...]:
    return tuple((x, y, z) for x, y, z in points.tolist())


def _unit(line: np.ndarray) -> Vector | None:
    """From the first point to the last."""
    along = line[-1] - line[0]
    length = float(np.linalg.norm(along))
    if length == 0:
        return None
    x, y, z = (along / length).tolist()
    return (x, y, z)


def _lam_along(line: np.ndarray, start: float, end: float) -> tuple[float, ...]:
    """λ of each point: it grows with the arc length, from start to end."""
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    fraction = arc / arc[-1] if arc[-1] > 0 else arc
    return tuple(np.clip(start + (end - start) * fraction, start, end).tolist())
