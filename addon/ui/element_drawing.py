# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay draws of the design elements, as arrays in the mesh's space, lifted off the surface. No GPU here.

    drawing = drawing_of(evaluated)
    drawing.shapes[i].fixed, drawing.shapes[i].at(lam)      # segments: what stays, and the ring where it is at λ

Each element is worked out again only when it or the surface has changed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..model.design import Element
from ..model.element_types import MOVING, RULES
from ..model.meetings import Meeting, meetings
from ..scene.read import freshness as reading
from ..scene.read.element_lines import element_lines
from ..scene.read.element_settings import kind_of
from ..scene.read.lambda_seen import passages
from ..scene.read.lambda_source import plain_keys
from ..session import freshness
from . import drawing_cache, palette
from . import element_shapes as shapes
from .element_rings import Rings
from .surface import Surface, laid, lift

#: Distance of points along a path, of arrows of travel, and their size, over the object's size.
STEP, ARROWS, HEAD = 1 / 150, 1 / 9, 1 / 60
NOTHING = np.zeros((0, 2, 3))
#: Elements of these types have a ring of their radius.
RINGED = MOVING | {"bifurcation"}
#: Whether the flow beside a line nears it, by the type or the kind of the element.
INWARD = {"attachment": True, "separation": False, "attracting": True, "repelling": False}


@dataclass
class Path:
    """A stroke of an element on the surface."""

    points: np.ndarray  #: (k, 3) lifted
    normals: np.ndarray  #: (k, 3)
    lam: np.ndarray  #: (k,)


@dataclass
class Shape:
    """One element."""

    index: int  #: in the list
    name: str
    type: str
    kind: str
    radius: float
    lam: tuple[float, float]
    paths: list[Path]
    fixed: np.ndarray  #: (l, 2, 3) path and arrows
    ticks: np.ndarray  #: (l, 2, 3) of λ, drawn while it is selected
    rings: Rings | None = None  #: of what has a radius around a place

    @property
    def moves(self) -> bool:
        return self.type in MOVING and any(len(path.points) > 1 for path in self.paths)

    def place(self, lam: float) -> np.ndarray | None:
        """Where it is at λ; None outside its life. Of what has no place of its own its beginning."""
        if not self.paths or not self.lam[0] - 1e-9 <= lam <= self.lam[1] + 1e-9:
            return None
        path = self.paths[0]
        if not self.moves or self.type == "regular":
            return path.points[0]
        return np.array([np.interp(lam, path.lam, path.points[:, axis]) for axis in range(3)])

    def at(self, lam: float) -> np.ndarray:
        """(l, 2, 3) the ring of the radius and the sign of the turning."""
        if self.rings is None or self.place(lam) is None:
            return NOTHING
        arc = float(np.interp(lam, self.paths[0].lam, self.rings.arc)) if self.moves else 0.0
        return segments(self.rings.at(arc))


@dataclass
class MeetingMark:
    words: str  #: "merge at λ 0.60, frame 54"
    position: np.ndarray  #: (3,) lifted
    normal: np.ndarray


@dataclass
class ElementsDrawing:
    shapes: list[Shape] = field(default_factory=list)
    meetings: list[MeetingMark] = field(default_factory=list)
    version: int = 0


@dataclass
class _Kept:
    asked: tuple = ()
    surface: Surface | None = None
    entries: dict[str, tuple] = field(default_factory=dict)  #: entry and shape by the element's name
    drawing: ElementsDrawing = field(default_factory=ElementsDrawing)


_kept: dict[int, _Kept] = {}


def forget() -> None:
    _kept.clear()


def drawing_of(evaluated: bpy.types.Object) -> ElementsDrawing:
    """The drawing of an evaluated object's elements."""
    obj = evaluated.original
    surface, mesh = drawing_cache.surface_of(evaluated)
    kept = _kept.setdefault(obj.session_uid, _Kept())
    asked = (freshness.elements_version(obj), palette.name())
    if kept.surface is surface and kept.asked == asked:
        return kept.drawing
    if kept.surface is not surface:
        kept.entries.clear()
    known, kept.entries = kept.entries, {}
    found = []
    for index, element in enumerate(obj.stormfield.elements):
        if not element.enabled or element.source is None:
            continue
        entry = reading.element_entry(obj, element)
        old = known.get(element.name)
        shape = old[1] if old is not None and old[0] == entry else _shape(obj, element, surface, mesh)
        shape.index = index
        kept.entries[element.name] = (entry, shape)
        found.append(shape)
    marks = _meeting_marks(obj, found, surface, mesh)
    kept.asked, kept.surface = asked, surface
    kept.drawing = ElementsDrawing(found, marks, kept.drawing.version + 1)
    return kept.drawing


def _shape(obj: bpy.types.Object, element, surface: Surface, mesh) -> Shape:
    always = element.from_animation or RULES[element.type].instant
    lam = (0.0, 1.0) if always else (element.lam_start, max(element.lam_start, element.lam_end))
    point = element.source.type == "EMPTY"
    paths = []
    for line in element_lines(obj, element.source):
        if point and element.type in MOVING:
            line = line[:1]
        elif point:  # as long as the element reaches
            line = np.stack([line[0], line[0] + element.radius * _unit(line[1] - line[0])])
        paths.append(_path(line, lam, surface, mesh))
    size = surface.size

    def lay(lines: list[np.ndarray]) -> list[np.ndarray]:
        return [laid(shapes.resampled(line, STEP * size), surface, mesh)[0] for line in lines]

    heads = [head for path in paths for head in _heads(element, path, size)]
    fixed = segments([path.points for path in paths] + lay(heads))
    timed = element.type in MOVING and not element.from_animation
    ticks = [
        tick for path in paths if timed for tick in shapes.ticks(path.points, path.normals, path.lam, 0.6 * HEAD * size)
    ]
    rings = _rings(element, paths[0], surface, mesh) if paths and element.type in RINGED else None
    return Shape(
        0, element.name, element.type, kind_of(element), element.radius, lam, paths, fixed, segments(lay(ticks)), rings
    )


def _heads(element, path: Path, size: float) -> list[np.ndarray]:
    """Arrows along a path, and on both sides of a line that flow gathers on or parts from."""
    onward = slice(None, None, -1 if element.type == "orbit" and element.reverse else 1)
    points, normals = path.points[onward], path.normals[onward]
    heads = shapes.chevrons(points, normals, ARROWS * size, HEAD * size)
    inward = INWARD.get(element.type, INWARD.get(kind_of(element)))
    if inward is not None:
        heads += shapes.side_arrows(points, normals, ARROWS * size, HEAD * size, inward)
    return heads


def _rings(element, path: Path, surface: Surface, mesh) -> Rings:
    signs = {"singular": shapes.sign, "bifurcation": shapes.event_sign}
    sign = signs[element.type](kind_of(element), element.angle) if element.type in signs else []
    return Rings(path.points, path.normals[0], element.radius, sign, (surface, mesh))


def _path(line: np.ndarray, lam: tuple[float, float], surface: Surface, mesh) -> Path:
    if len(line) == 1:
        points, normals = lift(line, surface, mesh)
        return Path(points, normals, np.array([lam[0]]))
    arc = shapes.arc_length(line)
    share = arc / arc[-1] if arc[-1] > 0 else arc
    fine, times = shapes.resampled(line, STEP * surface.size, lam[0] + share * (lam[1] - lam[0]))
    points, normals, at = laid(fine, surface, mesh)
    return Path(points, normals, np.interp(at, np.arange(len(times)), times))


def _meeting_marks(obj, found: list[Shape], surface: Surface, mesh) -> list[MeetingMark]:
    marks = []
    for meeting in meetings(_plain(found)):
        (place,), (normal,) = lift(meeting.position[None], surface, mesh)
        marks.append(MeetingMark(_said(obj, meeting), place, normal))
    return marks


def _plain(found: list[Shape]) -> list[Element]:
    """Moving fixed points as the model knows them."""
    return [
        Element(
            shape.name,
            "singular",
            tuple((x, y, z) for x, y, z in path.points.tolist()),
            lam=tuple(path.lam.tolist()),
            radius=shape.radius,
        )
        for shape in found
        if shape.type == "singular"
        for path in shape.paths
        if len(path.points) > 1
    ]


def _said(obj: bpy.types.Object, meeting: Meeting) -> str:
    # Drawing never goes through the frames, as λ that is not keyed would need.
    frames = passages(bpy.context, obj, [meeting.lam])[0] if plain_keys(obj) is not None else []
    when = f", frame {frames[0][0]}" if frames else ""
    return f"{meeting.words} at λ {meeting.lam:.2f}{when}"


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(float(np.linalg.norm(vector)), 1e-30)


def segments(lines: Sequence[np.ndarray]) -> np.ndarray:
    """(l, 2, 3) of polylines (k, 3)."""
    pairs = [np.stack([line[:-1], line[1:]], axis=1) for line in lines if len(line) > 1]
    return np.concatenate(pairs) if pairs else NOTHING
