# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay has worked out for each object, kept until field, λ or settings change. Reads bpy data only."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import native
from ..model.words import MorseMethod
from ..scene.read.mesh import loop_triangles
from ..session import morse_state
from . import field_drawing
from .field_drawing import Surface

#: A fixed point whose divergence is less than this fraction of its curl is shown as a center.
CENTER_TOLERANCE = 0.05
#: Below this fraction of the highest speed there is no field (a component of the mesh without element).
NO_FIELD = 1e-6


EMPTY = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


@dataclass
class Drawing:
    """Lines and fixed points of one object at one λ, in its own space."""

    lines: np.ndarray  #: (l, 2, 3) ends of line segments
    colours: np.ndarray  #: (l, 2, 4)
    points: list[tuple[str, np.ndarray]]  #: kind and position of every fixed point
    note: str = ""
    batch: object = None  #: GPU batch of the lines, made at the first draw


@dataclass
class _Entry:
    shape: tuple = (-1, None, None)  #: what `surface` was made from: polygons, positions, corners
    surface: Surface = EMPTY
    mesh: object = None  #: native TriangleMesh, or None where the evaluated mesh is no surface
    note: str = ""
    seeds: dict = field(default_factory=dict)
    values: np.ndarray | None = None  #: (n, 3) of the field that is drawn
    taus: dict = field(default_factory=dict)  #: starting values by method, once computed
    compared: tuple = ()  #: generation of the object when its shape was last compared
    key: tuple = ()
    drawing: Drawing | None = None


_entries: dict[int, _Entry] = {}
_generations: dict[int, int] = {}


def forget() -> None:
    _entries.clear()
    _generations.clear()


def mark_changed(depsgraph: bpy.types.Depsgraph) -> None:
    for update in depsgraph.updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            uid = update.id.original.session_uid
            _generations[uid] = _generations.get(uid, 0) + 1


def drawing_of(evaluated: bpy.types.Object) -> Drawing | None:
    """The drawing of an evaluated object, or None where it carries no field yet."""
    settings, mesh = evaluated.original.stormfield.look, evaluated.data
    attribute = mesh.attributes.get(settings.shown_field)
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "FLOAT_VECTOR":
        return None
    entry = _entries.setdefault(evaluated.original.session_uid, _Entry())
    key = (
        round(evaluated.stormfield.lam, 6),
        _generations.get(evaluated.original.session_uid, 0),
        len(mesh.vertices),
        settings.shown_field,
        settings.style,
        settings.density,
        round(settings.length, 3),
        round(settings.opacity, 3),
        settings.show_fixed_points,
    )
    if entry.drawing is None or entry.key != key:
        surface_of(evaluated)
        flat = np.empty(len(mesh.vertices) * 3, np.float32)
        attribute.data.foreach_get("vector", flat)
        values = flat.reshape(-1, 3).astype(np.float64)
        entry.values, entry.taus = values, {}
        entry.drawing = _draw(entry, values, settings)
        entry.key = key
    return entry.drawing


def surface_of(evaluated: bpy.types.Object):
    """Surface and native TriangleMesh (None where the mesh is no surface) of an evaluated object, as it is drawn."""
    entry = _entries.setdefault(evaluated.original.session_uid, _Entry())
    generation = (_generations.get(evaluated.original.session_uid, 0), len(evaluated.data.vertices))
    if entry.compared != generation:
        _update_surface(entry, evaluated.data)
        entry.compared = generation
    return entry.surface, entry.mesh


def starting_tau(obj: bpy.types.Object, method: MorseMethod) -> float | None:
    """The τ that mesh and field suggest: seconds, or mesh units for the method "spatial"; None before it was drawn."""
    entry = _entries.get(obj.session_uid)
    if entry is None or entry.mesh is None or entry.values is None:
        return None
    if method not in entry.taus:
        entry.taus[method] = _starting_tau(entry, method)
    return entry.taus[method]


def _starting_tau(entry: _Entry, method: MorseMethod) -> float | None:
    try:
        return native.starting_tau(native.VectorField.from_space(entry.mesh, entry.values), morse_state.UNITS[method])
    except ValueError:  # of a field that is zero, or not finite
        return None


def _update_surface(entry: _Entry, mesh: bpy.types.Mesh) -> None:
    """Keep the surface while the evaluated mesh has the same shape: only its attributes follow λ."""
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", corners)
    shape = (len(mesh.polygons), vertices, corners)
    if all(np.array_equal(old, new) for old, new in zip(entry.shape, shape, strict=True)):
        return
    triangles, _loops = loop_triangles(mesh)
    entry.shape, entry.seeds, entry.mesh, entry.note = shape, {}, None, ""
    entry.surface = Surface(vertices.reshape(-1, 3).astype(np.float64), triangles)
    try:
        entry.mesh = native.TriangleMesh(entry.surface.vertices, entry.surface.triangles)
    except (ValueError, RuntimeError, ImportError) as fault:
        entry.note = f"Fixed points cannot be shown: {fault}"


def _draw(entry: _Entry, values: np.ndarray, settings) -> Drawing:
    surface = entry.surface
    empty = np.zeros((0, 2, 3))
    lines, colours = empty, np.zeros((0, 2, 4))
    if settings.style != "NONE" and len(surface.triangles):
        if settings.density not in entry.seeds:
            entry.seeds = {settings.density: field_drawing.spread_seeds(surface, settings.density)}
        seeds = entry.seeds[settings.density]
        if settings.style == "STROKES" and entry.mesh is not None:
            lines, colours = _stroke_lines(entry, values, seeds, settings)
        else:
            arrows, speed = field_drawing.arrows(surface, values, seeds, settings.length)
            lines = arrows.reshape(-1, 2, 3)
            colours = np.repeat(_colours(speed, settings.opacity), 6, axis=0).reshape(-1, 2, 4)
    points = []
    if settings.show_fixed_points and entry.mesh is not None:
        speed = np.linalg.norm(values, axis=1)
        still = NO_FIELD * speed.max(initial=0.0)
        flow = native.VectorField.from_space(entry.mesh, values)
        found = native.fixed_points(flow, relative_tolerance=CENTER_TOLERANCE)
        found = [point for point in found if speed[surface.triangles[point.face]].max() > still]
        if found:  # as high above the surface as separatrices, which would else miss them in close views
            faces, barycentric, positions = (
                np.array([getattr(point, name) for point in found]) for name in ("face", "barycentric", "position")
            )
            raised, _normals = field_drawing.lifted(surface, faces, barycentric, positions)
            points = [(point.kind, place) for point, place in zip(found, raised, strict=True)]
    return Drawing(lines, colours, points, entry.note)


def _stroke_lines(entry: _Entry, values, seeds, settings):
    drawn = field_drawing.strokes(entry.surface, entry.mesh, values, seeds, settings.length)
    colours = np.repeat(_colours(drawn.speed, settings.opacity), 2, axis=0).reshape(-1, 2, 4)
    colours[..., 3] *= drawn.along**1.5  # transparent behind, full at the front
    return drawn.lines, colours


def _colours(speed: np.ndarray, opacity: float) -> np.ndarray:
    """From calm blue to bright sand with the speed."""
    slow, fast = np.array([0.25, 0.55, 0.85]), np.array([1.0, 0.93, 0.72])
    colours = np.empty((len(speed), 4))
    colours[:, :3] = slow + (fast - slow) * speed[:, None]
    colours[:, 3] = opacity
    return colours
