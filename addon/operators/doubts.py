# SPDX-License-Identifier: GPL-3.0-or-later
"""Cures for what a solve had doubts about: a mesh that is too coarse, parts without an element, normals inward."""

import bmesh
import bpy
import numpy as np
from bpy.props import IntProperty
from mathutils import Matrix, Vector

from .. import native
from ..analysis.doubts import ENOUGH, DoubtKind, parts_without_field
from ..cache.field_cache import open_cache
from ..cache.fields import native_mesh, on_surface
from ..model.manifold import manifold
from ..scene.read.active_field import active_field
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.mesh import read_mesh
from ..scene.write import doubts
from ..scene.write.elements import add_element
from ..session import coarse_mesh
from .shared import FieldOperator, report_fault

#: Most vertices that subdividing may make.
MAX_VERTICES = 2_000_000
#: Most parts that are filled at once.
MAX_PARTS = 200
FIELDS = ("sf_orientation", "sf_advection")


class CureOperator(FieldOperator):
    """Mix-in of operators that cure one kind of doubt."""

    cures: DoubtKind

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave Edit Mode first")
            return False
        return True


class STORMFIELD_OT_subdivide_mesh(CureOperator, bpy.types.Operator):
    """Divide every face of the mesh into smaller ones of the same shape, so that storms fit between the vertices"""

    bl_idname = "stormfield.subdivide_mesh"
    bl_label = "Subdivide Mesh"
    bl_options = {"REGISTER", "UNDO"}
    cures = "coarse"

    times: IntProperty(
        name="Times", description="How often each edge is halved (count); 0 takes what the storms need", min=0, max=10
    )

    def execute(self, context):
        obj = active_field(context)
        doubt = doubts.find(obj, self.cures)
        if self.times == 0:
            self.times = doubt.amount if doubt is not None else 1
        needed = len(obj.data.vertices) + len(obj.data.polygons) * 4**self.times
        if needed > MAX_VERTICES:
            self.report(
                {"ERROR"}, f"That makes some {needed:,} vertices; subdivide less often, or make the storms larger"
            )
            return {"CANCELLED"}
        if obj.modifiers.get("Multires") or any(modifier.type == "MULTIRES" for modifier in obj.modifiers):
            self.report(
                {"ERROR"}, f"'{obj.name}' has a Multiresolution modifier, which belongs to its faces; apply it first"
            )
            return {"CANCELLED"}
        with _EditedMesh(obj.data) as shape:
            bmesh.ops.triangulate(shape, faces=[face for face in shape.faces if len(face.verts) > 4])
            for _ in range(self.times):
                bmesh.ops.subdivide_edges(shape, edges=shape.edges[:], cuts=1, use_grid_fill=True)
        doubts.drop(obj, self.cures)
        self.report({"INFO"}, f"'{obj.name}' has {len(obj.data.vertices):,} vertices now; solve again")
        return {"FINISHED"}


class STORMFIELD_OT_solve_on_density(CureOperator, bpy.types.Operator):
    """Refine the mesh inside the solve until every storm has three edges across its radius; the mesh itself stays.
    Solve again afterwards"""

    bl_idname = "stormfield.solve_on_density"
    bl_label = "Solve on Density"
    bl_options = {"REGISTER", "UNDO"}
    cures = "coarse"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        obj = active_field(context)
        radius = _least_radius(obj)
        if radius is None:
            cls.poll_message_set("Place a storm first: the density follows from its radius")
            return False
        if radius < coarse_mesh.mean_edge(obj.data):
            cls.poll_message_set(
                "A storm is smaller than the mesh's edges, so its vertices cannot show it: Subdivide Mesh"
            )
            return False
        return True

    def execute(self, context):
        obj = active_field(context)
        radius = _least_radius(obj)
        if radius is None:
            return {"CANCELLED"}
        edge = radius / ENOUGH
        needed = len(obj.data.vertices) * (coarse_mesh.mean_edge(obj.data) / edge) ** 2
        if needed > MAX_VERTICES:
            self.report({"ERROR"}, f"That solves some {needed:,.0f} vertices; make the storms larger")
            return {"CANCELLED"}
        settings = obj.stormfield.solve
        settings.solve_on, settings.edge = "DENSITY", edge
        doubts.drop(obj, self.cures)
        self.report({"INFO"}, f"'{obj.name}' is solved with edges of at most {edge:.2g}; solve again")
        return {"FINISHED"}


def _least_radius(obj: bpy.types.Object) -> float | None:
    """Of the storms that are turned on, mesh units; None without any."""
    elements = obj.stormfield.elements
    return min((each.radius for each in elements if each.enabled and each.type == "singular"), default=None)


class STORMFIELD_OT_fix_normals(CureOperator, bpy.types.Operator):
    """Turn the faces of the mesh so that they point outward, as Recalculate Outside does"""

    bl_idname = "stormfield.fix_normals"
    bl_label = "Fix Normals"
    bl_options = {"REGISTER", "UNDO"}
    cures = "inward"

    def execute(self, context):
        obj = active_field(context)
        with _EditedMesh(obj.data) as shape:
            bmesh.ops.recalc_face_normals(shape, faces=shape.faces[:])
        doubts.drop(obj, self.cures)
        self.report({"INFO"}, f"The faces of '{obj.name}' point outward now; solve again")
        return {"FINISHED"}


class STORMFIELD_OT_leave_out_parts(CureOperator, bpy.types.Operator):
    """Parts of the mesh without an element stay without flow, and nothing is said of them any more"""

    bl_idname = "stormfield.leave_out_parts"
    bl_label = "Leave Out"
    bl_options = {"REGISTER", "UNDO"}
    cures = "no_element"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if doubts.find(active_field(context), cls.cures) is None:
            cls.poll_message_set("Every part of the mesh has an element, or is left out already")
            return False
        return True

    def execute(self, context):
        obj = active_field(context)
        doubt = doubts.find(obj, self.cures)
        obj.stormfield.left_out = doubt.amount if doubt is not None else 0
        return {"FINISHED"}


class STORMFIELD_OT_fill_parts(CureOperator, bpy.types.Operator):
    """Give every part of the mesh without an element a wind direction: an arrow on it that you may turn"""

    bl_idname = "stormfield.fill_parts"
    bl_label = "Fill"
    bl_options = {"REGISTER", "UNDO"}
    cures = "no_element"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if attached_folder(active_field(context), LAMBDA) is None:
            cls.poll_message_set("Solve first: parts without an element are found in the solved field")
            return False
        return True

    def execute(self, context):
        obj = active_field(context)
        try:
            mesh = read_mesh(obj)
            found = manifold(mesh, obj.stormfield.solve.weld)
            surface = native_mesh(found.mesh)
            parts = parts_without_field(surface, on_surface(solved_fields(obj, mesh), found))
        except (ValueError, OSError, RuntimeError) as fault:
            return report_fault(self, fault)
        for part in parts[:MAX_PARTS]:
            _add_wind(context, obj, surface, part)
        doubts.drop(obj, self.cures)
        left = f"; {len(parts) - MAX_PARTS} are left" if len(parts) > MAX_PARTS else ""
        self.report(
            {"INFO"}, f"{min(len(parts), MAX_PARTS)} parts of '{obj.name}' have a wind direction now; solve again{left}"
        )
        return {"FINISHED"}


def solved_fields(obj: bpy.types.Object, mesh) -> dict[str, np.ndarray]:
    """The solved vectors over all λ, the largest of each vertex. Raises InputError: no cache, or of another mesh."""
    folder = attached_folder(obj, LAMBDA)
    if folder is None:
        return {}
    cache = open_cache(folder)
    cache.check_mesh(mesh)
    middle = cache.sample(len(cache.lambdas) // 2)
    return {name: middle[name] for name in FIELDS if name in middle}


def _add_wind(context, obj: bpy.types.Object, surface: "native.TriangleMesh", part: int) -> None:
    """An arrow along x at the front of the part, in its surface."""
    vertices = np.asarray(surface.vertices)
    own = np.flatnonzero(np.asarray(surface.components) == part)
    place = Vector(vertices[own[np.argmin(vertices[own, 1])]])
    _found, place, normal, _face = obj.closest_point_on_mesh(place)
    along = Vector((1.0, 0.0, 0.0)) - normal.x * normal
    along = along.normalized() if along.length > 0.1 else normal.orthogonal().normalized()
    arrow = bpy.data.objects.new("Wind", None)
    arrow.empty_display_type = "SINGLE_ARROW"
    arrow.empty_display_size = max(1e-3, 0.3 * float(np.ptp(vertices[own], axis=0).max()))
    arrow.parent = obj
    turn = Matrix((along, normal.cross(along), normal)).transposed().to_4x4()
    arrow.matrix_basis = Matrix.Translation(place) @ turn
    for collection in obj.users_collection or [context.scene.collection]:
        collection.objects.link(arrow)
    add_element(obj, arrow, type="regular")


class _EditedMesh:
    """A mesh as a BMesh, written back at the end."""

    def __init__(self, mesh: bpy.types.Mesh):
        self._mesh = mesh

    def __enter__(self) -> bmesh.types.BMesh:
        self._shape = bmesh.new()
        self._shape.from_mesh(self._mesh)
        return self._shape

    def __exit__(self, *exception) -> None:
        if exception[0] is None:
            self._shape.to_mesh(self._mesh)
            self._mesh.update()
        self._shape.free()


CLASSES = (
    STORMFIELD_OT_subdivide_mesh,
    STORMFIELD_OT_solve_on_density,
    STORMFIELD_OT_fix_normals,
    STORMFIELD_OT_leave_out_parts,
    STORMFIELD_OT_fill_parts,
)
