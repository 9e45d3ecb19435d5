# SPDX-License-Identifier: GPL-3.0-or-later
"""The analysis in the 3D view: separatrices, orbits and paths as lines, Morse sets as faces, the selected entity.

Lines keep their width at any zoom, fade when λ has moved away from what was analyzed, and are hidden by the surface.
"""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from ..analysis.colours import lam_colours
from ..scene.read import results
from ..session import morse_preview
from . import analysis_drawing, drawing_cache, legend, marker_drawing, markers, polylines, view_text
from .marker_drawing import Marker

#: Opacity of separatrices and orbits of another λ than the one shown.
STALE = 0.22
#: Kinds that no fixed point's own marker stands for.
UNMARKED = frozenset({"repelling", "attracting", "trivial", "other"})
HALO = (1.0, 1.0, 1.0, 0.95)
#: Colours of the legend from λ = 0 to 1.
RAMP = tuple(map(tuple, lam_colours(np.linspace(0.0, 1.0, 13)).tolist()))


def draw(context: bpy.types.Context, obj: bpy.types.Object, evaluated: bpy.types.Object) -> None:
    analysis = obj.stormfield.analysis
    drawing = analysis_drawing.drawing_of(evaluated) if analysis.show else None
    if drawing is None:
        return
    unit = context.preferences.system.ui_scale
    current = analysis_drawing.is_current(obj, analysis.ecg)
    matrix = evaluated.matrix_world
    if drawing.faces is not None and analysis.show_sets:
        _draw_faces(context, matrix, drawing.faces, analysis.opacity * _mcg_strength(obj), unit)
    _draw_halo(context, matrix, obj, drawing, unit)
    for role, lines in drawing.lines.items():
        if _role_shown(analysis, role):
            strength = 1.0 if current or role == results.PATHS else STALE
            _draw_lines(context, matrix, lines, analysis.width * analysis_drawing.WIDTHS[role] * unit, strength)
    marks = _marks(obj, drawing)
    marker_drawing.draw(context, evaluated.matrix_world, marks)


def _mcg_strength(obj) -> float:
    return 1.0 if morse_preview.of(obj) or analysis_drawing.is_current(obj, obj.stormfield.analysis.mcg) else 0.4


def _role_shown(analysis, role: str) -> bool:
    return {
        results.SEPARATRICES: analysis.show_separatrices,
        results.ORBITS: analysis.show_orbits,
        results.PATHS: analysis.show_paths,
    }[role]


def _draw_lines(context, matrix, lines, width: float, strength: float) -> None:
    if lines.batch is None or lines.batch[0] != strength:
        lines.batch = (strength, polylines.batch(lines.ends, lines.colours * (1.0, 1.0, 1.0, strength)))
    polylines.draw(context, matrix, lines.batch[1], width)


def _draw_halo(context, matrix, obj, drawing, unit: float) -> None:
    """White beneath the curves of the selected entity."""
    analysis = obj.stormfield.analysis
    if analysis.list(analysis.shown).selected() is None:
        return
    roles = tuple(role for role in drawing.lines if _role_shown(analysis, role))
    key = (analysis.shown, analysis.list(analysis.shown).active, analysis.show_sets, roles)
    if drawing.halo is None or drawing.halo[0] != key:
        ends = _halo(analysis, drawing, roles)
        white = np.broadcast_to(HALO, (len(ends), 2, 4))
        drawing.halo = (key, polylines.batch(ends, white) if len(ends) else None)
    if drawing.halo[1] is not None:
        polylines.draw(context, matrix, drawing.halo[1], (1.4 * analysis.width + 3.0) * unit)


def _halo(analysis, drawing, roles) -> np.ndarray:
    """(l, 2, 3) the lines of the selected entity."""
    index = analysis.list(analysis.shown).active
    ends: list[np.ndarray] = [np.zeros((0, 2, 3))]
    if analysis.shown == "mcg" and drawing.faces is not None and analysis.show_sets:
        faces = drawing.faces
        ends.append(faces.border[(faces.border_sets == index).any(axis=1)])
    for role in roles:
        if analysis.shown == ("history" if role == results.PATHS else "ecg"):
            ends.append(drawing.lines[role].of(index))
    return np.concatenate(ends)


def _draw_faces(context, matrix, faces, opacity: float, unit: float) -> None:
    shader = compat.builtin_shader("SMOOTH_COLOR")
    if faces.batch is None or faces.batch[0] != opacity:
        colours = (faces.colours * (1.0, 1.0, 1.0, opacity)).astype(np.float32)
        faces.batch = (
            opacity,
            batch_for_shader(shader, "TRIS", {"pos": faces.corners.astype(np.float32), "color": colours}),
        )
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(matrix)
        faces.batch[1].draw(shader)
    if faces.border_batch is None:
        dark = np.broadcast_to((0.02, 0.02, 0.03, 0.8), (len(faces.border), 2, 4))
        faces.border_batch = polylines.batch(faces.border, dark)
    polylines.draw(context, matrix, faces.border_batch, 1.2 * unit)


# Marks and names ------------------------------------------------------------------------------------------------------


def visible_marks(obj: bpy.types.Object, drawing) -> list:
    """What can be clicked on now."""
    analysis = obj.stormfield.analysis
    marks = [mark for mark in drawing.marks if mark.which == "history" and analysis.show_paths]
    if analysis.shown == "history" and analysis.show_paths:
        marks += drawing.path_marks(obj.stormfield.lam)
    if analysis.show_sets and analysis.shown == "mcg":
        marks += [mark for mark in drawing.marks if mark.which == "mcg"]
    if analysis_drawing.is_current(obj, analysis.ecg) and analysis.shown == "ecg":
        marks += drawing.entities
    return marks


def _marks(obj, drawing) -> list[Marker]:
    """Bifurcations, brighter the nearer λ is; orbits and sets without a fixed point; a ring around the selected."""
    analysis = obj.stormfield.analysis
    shown = []
    for mark in visible_marks(obj, drawing):
        opacity, size = 1.0, 1.0
        if mark.lam is not None:
            opacity = 0.4 + 0.6 * np.exp(-(((mark.lam - obj.stormfield.lam) / 0.04) ** 2))
            size = 0.5 if mark.kind == "hopf" else 0.95
        selected = (mark.which, mark.index) == (analysis.shown, analysis.list(analysis.shown).active)
        if selected:
            opacity, size = 1.0, 1.0
        if mark.lam is not None:
            shown.append(Marker(mark.kind, mark.position, size, opacity))
        elif mark.kind in UNMARKED:
            shown.append(Marker(mark.kind, mark.position, 0.8))
        if selected:
            shown.append(Marker("ring", mark.position))
    return shown


def draw_names(context: bpy.types.Context, obj: bpy.types.Object, evaluated: bpy.types.Object) -> None:
    """Names beside the entities that face the viewer: of all, or of the selected one."""
    analysis = obj.stormfield.analysis
    drawing = analysis_drawing.drawing_of(evaluated) if analysis.show else None
    if drawing is None:
        return
    selected = (analysis.shown, analysis.list(analysis.shown).active)
    named = [
        mark
        for mark in visible_marks(obj, drawing)
        if (mark.which, mark.index) == selected or (analysis.show_names and mark.lam is None)
    ]
    view_text.draw(context, evaluated.matrix_world, [(mark.name, mark.position, mark.normal) for mark in named])


# Legend ---------------------------------------------------------------------------------------------------------------


def legend_blocks(obj: bpy.types.Object, evaluated: bpy.types.Object) -> list[legend.Block]:
    """Blocks of the analyses that were made and are shown."""
    analysis = obj.stormfield.analysis
    drawing = analysis_drawing.drawing_of(evaluated) if analysis.show else None
    if drawing is None:
        return []
    blocks = []
    if analysis.ecg.made and (analysis.show_separatrices or analysis.show_orbits):
        orbits = {kind: drawing.counts["ecg"][kind] for kind in ("repelling", "attracting")}
        if any(orbits.values()) or not analysis_drawing.is_current(obj, analysis.ecg):
            blocks.append(legend.Block(_title(obj, "Topology", analysis.ecg), _rows(orbits)))
    if analysis.history.made and analysis.show_paths:
        events = {kind: drawing.counts["history"][kind] for kind in markers.EVENTS}
        paths = drawing.counts["history"].total() - sum(events.values())
        named = {kind: drawing.words.get(kind, "").capitalize() or markers.NAMES[kind] for kind in markers.EVENTS}
        rows = tuple((kind, f"{named[kind]}  {events[kind]}") for kind in markers.EVENTS if events[kind])
        blocks.append(legend.Block(f"Over time: {paths} paths", rows, RAMP))
    preview = morse_preview.of(obj)
    if preview is not None and analysis.show_sets:
        counts = {kind: preview.kinds.count(kind) for kind in markers.NAMES}
        blocks.append(legend.Block(f"Preview  λ {preview.lam:.3f}", _rows(counts, " region")))
    elif analysis.mcg.made and analysis.show_sets:
        blocks.append(legend.Block(_title(obj, "Regions", analysis.mcg), _rows(drawing.counts["mcg"], " region")))
    return blocks


def _title(obj, what: str, entities) -> str:
    now = "" if analysis_drawing.is_current(obj, entities) else "  (not now)"
    return f"{what}  λ {entities.lam:.3f}{now}"


def _rows(counts, suffix: str = "") -> tuple[tuple[str, str], ...]:
    """suffix: so that a kind of set is not read as one more fixed point."""
    return tuple((kind, f"{name}{suffix}  {counts[kind]}") for kind, name in markers.NAMES.items() if counts.get(kind))


def forget() -> None:
    analysis_drawing.forget()
    drawing_cache.forget()
