# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's field → `MeshData` and `Design`: curves, empties and their animation in the mesh's object space.

Elements without animation are read at the current frame. Elements "from animation" are read at every frame between the
first and the last key of λ, and each place counts at that frame's λ; the scene is put back to its frame afterwards.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Matrix

from ...model.design import Design, Element, SolveSettings, Vector
from ...model.element_types import MOVING, RULES
from ...model.errors import InputError
from ...model.mesh_data import MeshData
from .curves import read_polylines, take_over_edits
from .edits import read_edits
from .element_keys import keyed_settings, numbers_of, with_numbers
from .element_settings import kind_of
from .lambda_seen import lambda_at_frames, lambda_frames, lambda_per_second
from .mesh import read_mesh
from .places import Placed, Places
from .seen_surface import SeenSurface

#: Most places that are read of an animated curve, which changes as a whole.
MAX_CURVES = 24
#: Widest gap between the ends of a loop that is closed by itself, over its length.
GAP = 0.2


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
    keyed = _keyed(obj)
    with Places(context) as placed:
        surface = SeenSurface(placed, obj)
        seen = _over_lambda(context, surface, [element for element in enabled if element.from_animation], keyed)
        mirrored = placed.matrix_world(obj).is_negative
        for element in enabled:
            index = _index(obj, element)
            places = seen.places[index] if element.from_animation else [_place(surface, element, element.lam_start)]
            made: Iterable[Element] = _elements(element, places)
            if index in seen.numbers:
                made = [with_numbers(each, seen.lams, seen.numbers[index]) for each in made]
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
            border=settings.border,
            edge=settings.edge if settings.solve_on == "DENSITY" else 0.0,
            lambda_per_second=lambda_per_second(context, obj),
        ),
    )


@dataclass(frozen=True)
class _Seen:
    """What was read frame by frame, in the order of λ; by the element's place in the list."""

    lams: list[float]
    places: dict[int, list[_Place]]
    numbers: dict[int, list[dict[str, float]]]


def _index(obj: bpy.types.Object, element) -> int:
    return next(index for index, each in enumerate(obj.stormfield.elements) if each == element)


def _keyed(obj: bpy.types.Object) -> dict[int, set[str]]:
    """Animated settings of the elements that are turned on."""
    elements = obj.stormfield.elements
    return {
        index: names
        for index, names in keyed_settings(obj).items()
        if index < len(elements) and elements[index].enabled
    }


def _over_lambda(context, surface: SeenSurface, moving, keyed: dict[int, set[str]]) -> _Seen:
    """Places of what is animated, and numbers that are; the frames are gone through once for all of them."""
    places: dict[int, list[_Place]] = {_index(surface.obj, element): [] for element in moving}
    numbers: dict[int, list[dict[str, float]]] = {index: [] for index in keyed}
    if not places and not numbers:
        return _Seen([], places, numbers)
    scene = context.scene
    before = scene.frame_current, scene.frame_subframe
    frames = lambda_frames(context, surface.obj)
    lams = lambda_at_frames(context, surface.obj, frames)
    taken: list[float] = []
    try:
        for frame, lam in zip(frames, lams, strict=True):
            if taken and lam <= taken[-1]:  # λ is constant or decreases: its place is known
                continue
            taken.append(lam)
            surface.places.at_frame(frame)
            for index, known in places.items():
                known.append(_place(surface, surface.obj.stormfield.elements[index], lam))
            evaluated = surface.places.of(surface.obj).evaluated.stormfield.elements if numbers else ()
            for index, values in numbers.items():
                values.append(numbers_of(evaluated[index], keyed[index]))
    finally:
        surface.places.at_frame(*before)
    return _Seen(taken, places, numbers)


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
    point = element.source.type == "EMPTY"
    if RULES[base.type].instant and element.from_animation:
        raise InputError(f"Element '{element.name}' happens at one λ; turn From Animation off")
    if point and RULES[base.type].closed:
        raise InputError(
            f"Element '{element.name}' goes round a loop, but its source is an empty; choose a closed curve"
        )
    if point and base.type in MOVING:
        yield _on_empty(base, places, tuple(place.lam for place in places) if element.from_animation else whole)
    elif element.from_animation:
        yield from _on_animated_curves(base, places, point)
    else:
        yield from _on_curves(base, places[0].lines, whole, point)


def _without_points(element) -> Element:
    """What an element of the list says, besides where it is."""
    instant = RULES[element.type].instant
    if element.lam_end < element.lam_start and not (element.from_animation or instant):
        raise InputError(
            f"Element '{element.name}' ends at λ {element.lam_end:g} before it starts at {element.lam_start:g}; "
            "exchange the two"
        )
    return Element(
        name=element.name,
        type=element.type,
        kind=kind_of(element),
        field=element.field,
        points=(),
        strength=element.strength,
        radius=element.radius,
        hard=element.hard,
        angle=element.angle,
        rate=element.pull,
        pull=element.pull,
        reverse=element.reverse,
        fade_in=0.0 if RULES[element.type].instant else element.fade_in,
        fade_out=0.0 if RULES[element.type].instant else element.fade_out,
        reach=element.reach,
        mode=element.mode,
        falloff=element.falloff,
    )


def _on_empty(base: Element, places: list[_Place], lam: tuple[float, ...]) -> Element:
    """A point, or one for each place where it moves; its X axis is that of the first place."""
    points = np.array([place.lines[0][0] for place in places])
    return replace(base, points=_rows(points), lam=lam, direction=_unit(places[0].lines[0]))


def _on_animated_curves(base: Element, places: list[_Place], point: bool) -> Iterator[Element]:
    """Curves that change as a whole: as they are at one λ, from there to the next."""
    chosen = places[:: -(-len(places) // MAX_CURVES)]
    for place, after in zip(chosen, [*chosen[1:], chosen[-1]], strict=True):
        yield from _on_curves(base, place.lines, (place.lam, after.lam), point, f" at λ {place.lam:.3f}")


def _on_curves(
    base: Element, lines: tuple[np.ndarray, ...], lam: tuple[float, ...], point: bool, suffix: str = ""
) -> Iterator[Element]:
    """One element per curve, numbered from the second on; of an empty (point) what is no path is an arrow."""
    for number, line in enumerate(lines, start=1):
        name = (base.name if number == 1 else f"{base.name} ({number})") + suffix
        if RULES[base.type].closed:
            _check_closed(base, line)
        if RULES[base.type].arrow or (point and base.type in {"attachment", "separation"}):
            lam = lam[:1] if RULES[base.type].instant else lam
            yield replace(base, name=name, points=_rows(line[:1]), lam=lam, direction=_unit(line))
        elif base.type in MOVING and len(line) > 1:
            yield replace(base, name=name, points=_rows(line), lam=_lam_along(line, lam[0], lam[-1]))
        else:
            yield replace(base, name=name, points=_rows(line), lam=lam)


def _check_closed(base: Element, line: np.ndarray) -> None:
    """Raises InputError where the ends of a loop are too far apart to be joined without asking."""
    length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    gap = float(np.linalg.norm(line[-1] - line[0]))
    if gap > GAP * length:
        raise InputError(
            f"Element '{base.name}': its curve is not closed, its ends are {gap:.3g} apart; "
            "close it (Edit Mode, Toggle Cyclic), or draw its end onto its begin"
        )


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
