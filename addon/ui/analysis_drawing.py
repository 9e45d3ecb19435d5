# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay draws of an analysis, as arrays: lines, marks, coloured faces, lifted off the surface. No GPU here.

Everything comes from the file (objects of the analysis, lists, the face attribute), so that a scene that was opened or
undone shows what it holds. Worked out again only when results, filters, shape or settings change.
"""

from collections import Counter
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..scene.read import morse_faces, results
from ..session import morse_preview
from . import drawing_cache, palette
from .surface import LIFT, Surface, lift

#: Widths of lines over the artist's line width.
WIDTHS = {results.SEPARATRICES: 1.0, results.ORBITS: 1.7, results.PATHS: 1.8}
#: Curves that begin at these kinds are dashed, so that patterns differ where colours may not; and a dash's length over
#: the object's size.
DASHED, DASH = frozenset({"source", "repelling"}), 0.012
#: λ nearer than this is the λ that was analyzed.
SAME_LAM = 5e-4


@dataclass
class Lines:
    """Curves of one role as segments; `owners` are the entities of each segment."""

    role: str
    ends: np.ndarray  #: (l, 2, 3)
    colours: np.ndarray  #: (l, 2, 4)
    owners: np.ndarray  #: (l, 2) int: ids of the entities it belongs to; twice the same for orbits and paths
    batch: object = None

    def of(self, entity: int) -> np.ndarray:
        """(k, 2, 3) segments of one entity."""
        return self.ends[(self.owners == entity).any(axis=1)]


@dataclass
class Mark:
    """A place to mark and to click on."""

    which: str  #: list
    index: int  #: in that list
    kind: str
    name: str
    position: np.ndarray  #: (3,)
    normal: np.ndarray  #: (3,)
    lam: float | None = None  #: of a bifurcation


@dataclass
class PathDrawing:
    """A path over λ, with the place of its fixed point at each."""

    index: int
    name: str
    kind: str
    lam: np.ndarray  #: (k,) increasing
    points: np.ndarray  #: (k, 3) lifted

    def mark(self, lam: float) -> Mark | None:
        """The fixed point at λ; None outside its life."""
        if not self.lam[0] <= lam <= self.lam[-1]:
            return None
        place = np.array([np.interp(lam, self.lam, self.points[:, axis]) for axis in range(3)])
        return Mark("history", self.index, self.kind, self.name, place, np.zeros(3))


@dataclass
class Faces:
    """Faces of the Morse sets, and the borders between sets."""

    corners: np.ndarray  #: (3 t, 3)
    colours: np.ndarray  #: (3 t, 4)
    border: np.ndarray  #: (l, 2, 3)
    border_sets: np.ndarray  #: (l, 2) ids on both sides
    batch: object = None
    border_batch: object = None


@dataclass
class AnalysisDrawing:
    lines: dict[str, Lines] = field(default_factory=dict)
    marks: list[Mark] = field(default_factory=list)  #: of events and sets; fixed points are marked by the field itself
    entities: list[Mark] = field(default_factory=list)  #: of the graph at its λ
    paths: list[PathDrawing] = field(default_factory=list)
    faces: Faces | None = None
    words: dict[str, str] = field(default_factory=dict)  #: by kind of event: "storms merge", where that holds for all
    _at: tuple[float, list[Mark]] | None = None
    halo: tuple | None = None  #: of the selected entity: for what, and its batch
    counts: dict[str, Counter] = field(default_factory=dict)  #: per list, how many of each kind pass the filters

    def path_marks(self, lam: float) -> list[Mark]:
        """The fixed points of the paths that live at λ."""
        if self._at is None or self._at[0] != lam:
            self._at = (lam, [mark for path in self.paths if (mark := path.mark(lam)) is not None])
        return self._at[1]


_drawings: dict[int, tuple[tuple, Surface, AnalysisDrawing]] = {}


def forget() -> None:
    _drawings.clear()


def is_current(obj: bpy.types.Object, entities) -> bool:
    """Whether a graph belongs to what is shown now: its λ and its field."""
    field_now = obj.stormfield
    return abs(field_now.lam - entities.lam) < SAME_LAM and field_now.look.shown_field == entities.shown_field


def drawing_of(evaluated: bpy.types.Object) -> AnalysisDrawing | None:
    """The drawing of an evaluated object's analysis; None where nothing was analyzed."""
    analysis = evaluated.original.stormfield.analysis
    live = evaluated.original.stormfield.morse.live
    if not (analysis.ecg.made or analysis.history.made or analysis.mcg.made or live):
        return None
    surface, mesh = drawing_cache.surface_of(evaluated)
    preview = morse_preview.of(evaluated.original)
    key = (
        preview and preview.version,
        analysis.version,
        palette.name(),
        *(_filter_key(analysis.list(which)) for which in ("ecg", "history", "mcg")),
    )
    kept = _drawings.get(evaluated.original.session_uid)
    if kept is None or kept[0] != key or kept[1] is not surface:
        kept = (key, surface, _make(evaluated, surface, mesh))
        _drawings[evaluated.original.session_uid] = kept
    return kept[2]


def _filter_key(entities) -> tuple:
    least = entities.id_data.stormfield.analysis.least_weight
    return tuple(sorted(entities.kinds)), entities.min_strength, entities.min_life, least


def _make(evaluated, surface: Surface, mesh) -> AnalysisDrawing:
    obj = evaluated.original
    analysis = obj.stormfield.analysis
    drawing = AnalysisDrawing()
    shown = {which: _passing(analysis.list(which)) for which in ("ecg", "history", "mcg")}
    drawing.counts = {
        which: Counter(item.kind for item, keep in zip(analysis.list(which).items, kept, strict=True) if keep)
        for which, kept in shown.items()
    }
    drawing.words = _words(analysis.history, shown["history"])
    for role, which, names in (
        (results.SEPARATRICES, "ecg", ("source", "target")),
        (results.ORBITS, "ecg", ("entity", "entity")),
        (results.PATHS, "history", ("entity", "entity")),
    ):
        lines = _lines(obj, role, names, analysis.list(which), surface, mesh)
        if lines is not None:
            drawing.lines[role] = lines
    drawing.paths = _paths(obj, analysis.history, shown["history"], surface, mesh)
    drawing.entities = _marks("ecg", analysis.ecg, shown["ecg"], surface, mesh)
    events = [i for i in np.flatnonzero(shown["history"]) if analysis.history.items[i].kind in results.EVENT_KINDS]
    drawing.marks = _marks("history", analysis.history, _only(shown["history"], events), surface, mesh)
    drawing.marks += _marks("mcg", analysis.mcg, shown["mcg"], surface, mesh)
    drawing.faces = _faces(evaluated, surface, analysis.mcg, shown["mcg"])
    return drawing


def _words(entities, shown: np.ndarray) -> dict[str, str]:
    """What artists call events of a kind, where one word holds for all that are shown."""
    said: dict[str, set[str]] = {}
    for item, keep in zip(entities.items, shown, strict=True):
        if keep and item.kind in results.EVENT_KINDS:
            said.setdefault(item.kind, set()).add(item.words)
    return {kind: next(iter(words)) for kind, words in said.items() if len(words) == 1}


def _passing(entities) -> np.ndarray:
    return np.array([entities.passes(item) for item in entities.items], bool)


def _only(shown: np.ndarray, indices) -> np.ndarray:
    kept = np.zeros_like(shown)
    kept[indices] = True
    return kept


def _lines(obj, role: str, names, entities, surface: Surface, mesh) -> Lines | None:
    curves = results.read_curves(obj, role)
    if not curves or not len(entities.items):
        return None
    shown = _passing(entities)
    wanted = np.array([entities.passes_filters(item) for item in entities.items], bool)
    owners = np.stack([results.read_attribute(obj, role, name) for name in names], axis=1)
    cuts = np.cumsum([len(c) for c in curves])[:-1]
    stored = np.split(results.read_attribute(obj, role, "colour"), cuts)
    raised = np.split(lift(np.concatenate(curves), surface, mesh)[0], cuts)
    ends, tints, belong = [], [], []
    for points, tint, owner in zip(raised, stored, owners, strict=True):
        # A separatrix may end at an orbit that is hidden because it is weak: its saddle is not.
        if not wanted[owner].all() or not shown[owner].any():
            continue
        kinds = [entities.items[int(i)].kind for i in owner]
        if role == results.ORBITS:
            points = np.r_[points, points[:1]]
        if role != results.PATHS:
            tint = _blend(palette.kind_colour(kinds[0]), palette.kind_colour(kinds[1]), len(points))
        segments = np.stack([points[:-1], points[1:]], axis=1)
        tint = np.stack([tint[:-1], tint[1:]], axis=1)
        if role != results.PATHS and kinds[0] in DASHED:
            kept = _dashes(points, DASH * surface.size)
            segments, tint = segments[kept], tint[kept]
        ends.append(segments)
        tints.append(tint)
        belong.append(np.tile(owner, (len(segments), 1)))
    if not ends:
        return None
    return Lines(role, np.concatenate(ends), np.concatenate(tints), np.concatenate(belong))


def _blend(start, end, count: int) -> np.ndarray:
    """(count, 4) from one colour to the other."""
    along = np.linspace(0.0, 1.0, count)[:, None]
    return np.c_[np.array(start) * (1.0 - along) + np.array(end) * along, np.ones(count)]


def _dashes(points: np.ndarray, length: float) -> np.ndarray:
    """(k - 1,) bool: segments that a dash covers, two thirds of them."""
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    middle = 0.5 * (arc[:-1] + arc[1:])
    return (middle / (1.5 * length)) % 1.0 < 2.0 / 3.0


def _paths(obj, entities, shown: np.ndarray, surface: Surface, mesh) -> list[PathDrawing]:
    curves = results.read_curves(obj, results.PATHS)
    if not curves or not len(shown):
        return []
    cuts = np.cumsum([len(curve) for curve in curves])[:-1]
    lam = np.split(results.read_attribute(obj, results.PATHS, "lam"), cuts)
    raised = np.split(lift(np.concatenate(curves), surface, mesh)[0], cuts)
    owners = results.read_attribute(obj, results.PATHS, "entity").tolist()
    items = entities.items
    return [
        PathDrawing(index, items[index].name, items[index].kind, times, points)
        for index, times, points in zip(owners, lam, raised, strict=True)
        if shown[index]
    ]


def _marks(which: str, entities, shown: np.ndarray, surface: Surface, mesh) -> list[Mark]:
    chosen = np.flatnonzero(shown)
    if not len(chosen):
        return []
    places = np.array([entities.items[int(i)].position[:] for i in chosen], np.float64)
    raised, normals = lift(places, surface, mesh)
    marks = []
    for i, place, normal in zip(chosen.tolist(), raised, normals, strict=True):
        item = entities.items[i]
        lam = item.lam if item.kind in results.EVENT_KINDS else None
        marks.append(Mark(which, i, item.kind, item.name, place, normal, lam))
    return marks


# Morse sets -----------------------------------------------------------------------------------------------------------


def _faces(evaluated, surface: Surface, entities, shown: np.ndarray) -> Faces | None:
    preview = morse_preview.of(evaluated.original)
    if preview is not None:
        evaluated.data.calc_loop_triangles()
        fits = len(preview.sets) == len(evaluated.data.loop_triangles)
        return paint_sets(surface, surface.triangle_values(preview.sets), preview.kinds) if fits else None
    sets = morse_faces.read(evaluated.data)
    if sets is None or not len(shown):
        return None
    sets = np.where((sets >= 0) & (sets < len(shown)), sets, -1)
    sets = np.where(np.r_[shown, False][sets], sets, -1)
    kinds = [item.kind for item in entities.items]
    return paint_sets(surface, surface.triangle_values(sets), kinds)


def paint_sets(surface: Surface, sets: np.ndarray, kinds: list[str]) -> Faces | None:
    """Coloured triangles of the sets (per triangle the set, -1 for none) and the borders around each set."""
    inside = np.flatnonzero(sets >= 0)
    if not len(inside):
        return None
    above = surface.vertices + 0.35 * LIFT * surface.size * surface.normals
    table = np.array([(*palette.kind_colour(kind), 1.0) for kind in kinds])
    triangles = surface.triangles
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    owner = np.repeat(sets, 3)
    order = np.lexsort(np.sort(edges, axis=1).T)
    ordered = np.sort(edges[order], axis=1)
    same = (ordered[1:] == ordered[:-1]).all(axis=1)
    first = np.flatnonzero(same)
    differ = owner[order[first]] != owner[order[first + 1]]
    between = first[differ]
    alone = np.ones(len(order), bool)
    alone[first] = alone[first + 1] = False
    rim = np.flatnonzero(alone & (owner[order] >= 0))
    places = np.concatenate([ordered[between], ordered[rim]])
    both = np.concatenate(
        [np.stack([owner[order[between]], owner[order[between + 1]]], 1), np.stack([owner[order[rim]]] * 2, 1)]
    )
    return Faces(above[triangles[inside]].reshape(-1, 3), np.repeat(table[sets[inside]], 3, 0), above[places], both)
