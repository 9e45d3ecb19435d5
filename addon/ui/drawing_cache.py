# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay has worked out for each object, kept until field, λ, shape or view change. Reads bpy data only."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import native
from ..analysis.quiet import is_storm
from ..model.manifold import manifold
from ..model.mesh_data import MeshData
from ..model.words import MorseMethod
from ..scene.read.mesh import loop_triangles
from ..session import morse_state
from .stroke_seeds import SeedLevels
from .stroke_shader import StrokeBatch
from .stroke_view import View, ViewStrokes
from .surface import Surface, lifted

#: A fixed point whose divergence is less than this fraction of its curl is shown as a center.
CENTER_TOLERANCE = 0.05
#: Below this fraction of the highest speed there is no field (a component of the mesh without element).
NO_FIELD = 1e-6
#: Views of one object whose strokes are kept.
MOST_VIEWS = 8

EMPTY = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int32))


@dataclass
class Drawing:
    """The field of one object at one λ, and its fixed points, in its own space."""

    values: np.ndarray  #: (n, 3) float32 at the vertices of the surface
    points: list[tuple[str, np.ndarray]]  #: kind and position of every fixed point
    note: str = ""


@dataclass
class _Entry:
    shape: tuple = (-1, None, None)  #: what `surface` was made from: polygons, positions, corners
    shape_number: int = 0  #: counts shapes
    surface: Surface = EMPTY
    mesh: object = None  #: native TriangleMesh, or None where the evaluated mesh is no surface
    note: str = ""
    seeds: SeedLevels | None = None
    views: dict[int, ViewStrokes] = field(default_factory=dict)  #: strokes of each view that shows it
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
    surface_of(evaluated)
    key = (
        entry.shape_number,
        round(evaluated.stormfield.lam, 6),
        _generations.get(evaluated.original.session_uid, 0),
        len(mesh.vertices),
        settings.shown_field,
        settings.show_fixed_points,
    )
    if entry.drawing is None or entry.key != key:
        flat = np.empty(len(mesh.vertices) * 3, np.float32)
        attribute.data.foreach_get("vector", flat)
        values = entry.surface.vertex_values(flat.reshape(-1, 3))
        points = _fixed_points(entry, values) if settings.show_fixed_points else []
        entry.drawing, entry.taus, entry.key = Drawing(values, points, entry.note), {}, key
    return entry.drawing


def strokes_of(evaluated: bpy.types.Object, number: int, view: View, spacing: float, length: float) -> StrokeBatch:
    """The strokes of an object that was drawn, in the view of that number; see ViewStrokes.batch."""
    entry = _entries[evaluated.original.session_uid]
    assert entry.drawing is not None and entry.seeds is not None
    if number not in entry.views:
        if len(entry.views) >= MOST_VIEWS:
            entry.views.clear()
        entry.views[number] = ViewStrokes(entry.surface, entry.mesh, entry.seeds)
    return entry.views[number].batch(view, entry.drawing.values, entry.key, spacing, length)


def surface_of(evaluated: bpy.types.Object):
    """Surface and native TriangleMesh (None where the mesh is no surface) of an evaluated object, as it is drawn."""
    entry = _entries.setdefault(evaluated.original.session_uid, _Entry())
    frame = bpy.context.scene.frame_current_final  # modifiers may move the mesh with it
    generation = (_generations.get(evaluated.original.session_uid, 0), len(evaluated.data.vertices), frame)
    if entry.compared != generation:
        _update_surface(entry, evaluated.data)
        entry.compared = generation
    return entry.surface, entry.mesh


def starting_tau(obj: bpy.types.Object, method: MorseMethod) -> float | None:
    """The τ that mesh and field suggest: seconds, or mesh units for the method "spatial"; None before it was drawn."""
    entry = _entries.get(obj.session_uid)
    if entry is None or entry.mesh is None or entry.drawing is None:
        return None
    if method not in entry.taus:
        entry.taus[method] = _starting_tau(entry, method)
    return entry.taus[method]


def _starting_tau(entry: _Entry, method: MorseMethod) -> float | None:
    try:
        return native.starting_tau(_native_field(entry.mesh, entry.drawing.values), morse_state.UNITS[method])
    except ValueError:  # of a field that is zero, or not finite
        return None


def _update_surface(entry: _Entry, mesh: bpy.types.Mesh) -> None:
    """Keep the surface while the evaluated mesh has the same shape: only its attributes follow λ."""
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.attributes["position"].data.foreach_get("vector", vertices)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", corners)
    shape = (len(mesh.polygons), vertices, corners)
    if all(_same(old, new) for old, new in zip(entry.shape, shape, strict=True)):
        return
    triangles, _loops = loop_triangles(mesh)
    entry.shape, entry.views, entry.mesh, entry.note = shape, {}, None, ""
    entry.shape_number += 1
    entry.surface = Surface(vertices.reshape(-1, 3).astype(np.float64), triangles)
    try:
        entry.surface, entry.mesh = _native_surface(entry.surface)
    except (ValueError, RuntimeError, ImportError) as fault:
        entry.note = f"Fixed points cannot be shown: {fault}"
    parts = None if entry.mesh is None else entry.mesh.components[entry.surface.triangles[:, 0]]
    entry.seeds = SeedLevels(entry.surface, parts)


def _same(old, new) -> bool:
    """Bit for bit, eight bytes at a time where that is possible: this is asked at every λ."""
    if isinstance(old, np.ndarray) and old.nbytes == new.nbytes and old.nbytes % 8 == 0:
        old, new = old.view(np.int64), new.view(np.int64)
    return np.array_equal(old, new)


def _native_surface(surface: Surface):
    """The surface that a solve would take, and the core's mesh of it. Raises InputError where there is none."""
    try:
        mesh = native.TriangleMesh(surface.vertices, surface.triangles)
        if not _has_inward_parts(surface, mesh):
            return surface, mesh
    except ValueError:
        pass
    taken = manifold(MeshData(surface.vertices, surface.triangles))
    part = Surface(taken.mesh.vertices, taken.mesh.triangles, taken)
    return part, native.TriangleMesh(part.vertices, part.triangles)


def _has_inward_parts(surface: Surface, mesh) -> bool:
    """Whether a closed part has its normals inside: lines that are lifted along them could not be seen."""
    if mesh.boundary_loop_count:
        return False
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    volumes = np.einsum("kd,kd->k", a, np.cross(b, c))
    return bool((np.bincount(mesh.components[surface.triangles[:, 0]], volumes) < 0).any())


def _fixed_points(entry: _Entry, values: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Kind and place of each, as high above the surface as separatrices, which would else miss them in close views."""
    if entry.mesh is None:
        return []
    found = native.fixed_points(_native_field(entry.mesh, values), relative_tolerance=CENTER_TOLERANCE)
    still = NO_FIELD * float(max(values.max(initial=0.0), -values.min(initial=0.0)))
    triangles = entry.surface.triangles
    found = [point for point in found if np.linalg.norm(values[triangles[point.face]], axis=1).max() > still]
    if not found:
        return []
    faces, barycentric, positions = (
        np.array([getattr(point, name) for point in found]) for name in ("face", "barycentric", "position")
    )
    raised, _normals = lifted(entry.surface, faces, barycentric, positions)
    return [(_marked_as(point), place) for point, place in zip(found, raised, strict=True)]


def _marked_as(point) -> str:
    """A storm is a storm whether its centre draws in or pushes out a little, which may change along its way."""
    return "storm" if is_storm(point.jacobian) else point.kind


def _native_field(mesh, values: np.ndarray):
    return native.VectorField.from_space(mesh, values.astype(np.float64))
