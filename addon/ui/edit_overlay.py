# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits in the 3D view before they are made: the faces that would change, where a point would stand, legal partners of
the selected entity with a glow and others greyed, what Simplify would take away."""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from ..operators.edit_choice import picked
from ..session import edit_ghost, edit_preview
from . import analysis_drawing, drawing_cache, marker_drawing
from .marker_drawing import Marker
from .surface import LIFT, Surface, lift

ALLOWED, REFUSED, OPEN = (0.25, 0.85, 0.45), (0.95, 0.2, 0.15), (0.75, 0.75, 0.75)
OPACITY, RIM = 0.3, 0.95

_batches: dict[tuple, tuple] = {}


def forget() -> None:
    _batches.clear()
    edit_ghost.forget()


def draw(context: bpy.types.Context, obj: bpy.types.Object, evaluated: bpy.types.Object) -> None:
    """The caller has set blending and depth test."""
    ghost, analysis = edit_ghost.of(obj), obj.stormfield.analysis
    if ghost is None and not (analysis.show and analysis.ecg.made):
        return
    surface, mesh = drawing_cache.surface_of(evaluated)
    unit = context.preferences.system.ui_scale
    marks: list[Marker] = []
    if ghost is not None:
        colour = OPEN if ghost.allowed is None else ALLOWED if ghost.allowed else REFUSED
        if ghost.faces is not None:
            _draw_block(context, evaluated, surface, ghost.faces, colour, unit)
        if ghost.place is not None:
            place = lift(ghost.place[None], surface, mesh)[0][0]
            around = {True: "glow", False: "cross", None: "ring"}[ghost.allowed]
            marks += [Marker(ghost.kind, place, 1.1), Marker(around, place)]
    else:
        marks += _previewed(context, obj, evaluated, surface, mesh, unit)
    marker_drawing.draw(context, evaluated.matrix_world, marks)


def _previewed(context, obj, evaluated, surface: Surface, mesh, unit: float) -> list[Marker]:
    drawing = analysis_drawing.drawing_of(evaluated)
    analysis = obj.stormfield.analysis
    if drawing is None or analysis.shown != "ecg" or not analysis_drawing.is_current(obj, analysis.ecg):
        return []
    partners, simpler = edit_preview.partners(obj), edit_preview.simpler(obj)
    chosen, active = picked(obj), obj.stormfield.analysis.ecg.active
    if len(chosen) == 2 and active in chosen:
        partner = partners.get(next(index for index in chosen if index != active))
        if partner is not None and not partner.reason:
            _draw_block(context, evaluated, surface, partner.faces, ALLOWED, unit)
    marks = []
    for mark in drawing.entities:
        partner = partners.get(mark.index)
        if simpler is not None and mark.index in simpler.vanish:
            marks.append(Marker("cross", mark.position))
        elif mark.index in chosen and mark.index != active:
            marks.append(Marker("ring", mark.position))
        elif partner is not None:
            marks.append(Marker("veil" if partner.reason else "glow", mark.position))
    if simpler is not None and simpler.new:
        raised, _ = lift(np.array([entity.at for entity in simpler.new]), surface, mesh)
        marks += [Marker(entity.kind, place) for entity, place in zip(simpler.new, raised, strict=True)]
    return marks


def _draw_block(context, evaluated, surface: Surface, faces: np.ndarray, colour, unit: float) -> None:
    """Faces as a coloured film with a rim."""
    if not len(faces) or faces.max() >= len(surface.triangles):  # the mesh is another one by now
        return
    key = (evaluated.original.session_uid, faces.tobytes(), colour, id(surface))
    if key not in _batches:
        _batches.clear()
        _batches[key] = _block_batches(surface, faces, colour)
    film, rim = _batches[key]
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(evaluated.matrix_world)
        film.draw(compat.builtin_shader("SMOOTH_COLOR"))
        shader = compat.builtin_shader("POLYLINE_SMOOTH_COLOR")
        shader.bind()
        shader.uniform_float("viewportSize", (context.region.width, context.region.height))
        shader.uniform_float("lineWidth", 2.0 * unit)
        rim.draw(shader)


def _block_batches(surface: Surface, faces: np.ndarray, colour) -> tuple:
    corners = surface.triangles[faces]
    above = surface.vertices + 0.5 * LIFT * surface.size * surface.normals
    edges = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    border = unique[counts == 1].reshape(-1)
    return (
        _batch("SMOOTH_COLOR", "TRIS", above[corners.reshape(-1)], (*colour, OPACITY)),
        _batch("POLYLINE_SMOOTH_COLOR", "LINES", above[border], (*colour, RIM)),
    )


def _batch(shader: str, kind: str, places: np.ndarray, colour: tuple[float, ...]):
    content = {"pos": places.astype(np.float32), "color": np.tile(np.array(colour, np.float32), (len(places), 1))}
    return batch_for_shader(compat.builtin_shader(shader), kind, content)
