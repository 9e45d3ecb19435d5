# SPDX-License-Identifier: GPL-3.0-or-later
"""The design elements in the 3D view: lines in their kind's colour within a dark rim, rings, names, and meetings."""

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..scene.read.active_field import active_field
from . import element_drawing, marker_drawing, palette, polylines, view_text
from .element_drawing import Shape
from .marker_drawing import Marker

#: Widths in pixels at 100 % interface scale: of lines, of the selected element's, and of the rim around both.
WIDTH, SELECTED, RIM = 2.2, 3.2, 2.6
DARK, HALO = (0.02, 0.02, 0.03, 0.85), (1.0, 1.0, 1.0, 1.0)


@dataclass
class _Lines:
    """Lines of one width within a rim, sent to the GPU."""

    lines: object
    rims: object
    width: float


@dataclass
class _Batches:
    """What was sent to the GPU of one object, and for what: lines that stay, and those that move with λ."""

    staying: tuple = ()
    moving: tuple = ()
    fixed: list[_Lines] = field(default_factory=list)
    rings: list[_Lines] = field(default_factory=list)


_batches: dict[int, _Batches] = {}


def forget() -> None:
    _batches.clear()
    element_drawing.forget()


def draw(context: bpy.types.Context, obj: bpy.types.Object, evaluated: bpy.types.Object) -> None:
    drawing = element_drawing.drawing_of(evaluated)
    if not drawing.shapes:
        return
    lam, chosen = evaluated.stormfield.lam, selected(context, obj)
    kept = _batches.setdefault(obj.session_uid, _Batches())
    staying = (drawing.version, chosen)
    if kept.staying != staying:
        kept.staying = staying
        kept.fixed = _make(drawing.shapes, chosen, lambda shape: _staying(shape, shape.index in chosen))
    ringed = [shape for shape in drawing.shapes if shape.rings is not None]  # while it lives
    moving = (*staying, lam if ringed else 0.0)
    if kept.moving != moving:
        kept.moving = moving
        kept.rings = _make(ringed, chosen, lambda shape: shape.at(lam))
    unit = context.preferences.system.ui_scale
    for made in (*kept.fixed, *kept.rings):
        polylines.draw(context, evaluated.matrix_world, made.rims, (made.width + RIM) * unit)
        polylines.draw(context, evaluated.matrix_world, made.lines, made.width * unit)
    marks = [Marker("meeting", mark.position, 0.9) for mark in drawing.meetings]
    marker_drawing.draw(context, evaluated.matrix_world, marks)


def selected(context: bpy.types.Context, obj: bpy.types.Object) -> frozenset[int]:
    """Elements whose source is selected in the view, and the active one of the field that is worked on."""
    field_now = obj.stormfield
    chosen = {
        index
        for index, element in enumerate(field_now.elements)
        if element.source is not None and element.source.select_get(view_layer=context.view_layer)
    }
    if active_field(context) == obj:
        chosen.add(field_now.active_element)
    return frozenset(chosen)


def _staying(shape: Shape, chosen: bool) -> np.ndarray:
    return np.concatenate([shape.fixed, shape.ticks]) if chosen else shape.fixed


def _make(drawn: list[Shape], chosen: frozenset[int], ends_of: Callable[[Shape], np.ndarray]) -> list[_Lines]:
    made = []
    for is_chosen, width, rim in ((False, WIDTH, DARK), (True, SELECTED, HALO)):
        shapes = [shape for shape in drawn if (shape.index in chosen) == is_chosen]
        ends = [ends_of(shape) for shape in shapes]
        if not sum(map(len, ends)):
            continue
        colours = np.concatenate([_colours(shape, len(end)) for shape, end in zip(shapes, ends, strict=True)])
        joined = np.concatenate(ends)
        rims = np.broadcast_to(rim, (len(joined), 2, 4))
        made.append(_Lines(polylines.batch(joined, colours), polylines.batch(joined, rims), width))
    return made


def _colours(shape: Shape, count: int) -> np.ndarray:
    return np.broadcast_to((*palette.element_colour(shape.type, shape.kind), 1.0), (count, 2, 4))


def draw_names(context: bpy.types.Context, obj: bpy.types.Object, evaluated: bpy.types.Object) -> None:
    """Names of selected elements, and where paths meet."""
    drawing = element_drawing.drawing_of(evaluated)
    texts = []
    chosen = selected(context, obj)
    for shape in drawing.shapes:
        if shape.index not in chosen or not shape.paths:
            continue
        place = shape.place(evaluated.stormfield.lam)
        path = shape.paths[0]
        near = int(np.argmin(np.linalg.norm(path.points - place, axis=1))) if place is not None else 0
        text = shape.name if not shape.moves else f"{shape.name}  λ {shape.lam[0]:.2f}–{shape.lam[1]:.2f}"
        texts.append((text, path.points[near], path.normals[near]))
    for mark in drawing.meetings:
        texts.append((mark.words, mark.position, mark.normal))
    view_text.draw(context, evaluated.matrix_world, texts)
