# SPDX-License-Identifier: GPL-3.0-or-later
"""Show the artist where a mesh is no surface."""

import bpy
import numpy as np

from ..model.manifold import Remarks, manifold
from ..scene.read.active_field import active_field
from ..scene.read.mesh import loop_triangles, read_mesh
from .shared import FieldOperator


class STORMFIELD_OT_select_faults(FieldOperator, bpy.types.Operator):
    """Select, in Edit Mode, what of the mesh is no surface: edges with more than two faces, parts that touch in a
    point, faces without area, faces that lie on others, normals that point inward, and seams that Join Seams joins"""

    bl_idname = "stormfield.select_faults"
    bl_label = "Select in Edit Mode"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        obj = active_field(context)
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        remarks = manifold(read_mesh(obj), obj.stormfield.solve.weld).remarks
        if remarks.clean:
            self.report({"INFO"}, f"'{obj.name}' is a surface without faults")
            return {"FINISHED"}
        _select(obj.data, remarks)
        context.view_layer.objects.active = obj
        bpy.ops.object.mode_set(mode="EDIT")
        context.tool_settings.mesh_select_mode = (True, False, False)
        self.report({"INFO"}, f"'{obj.name}': {remarks.line()}")
        return {"FINISHED"}


def _select(mesh: bpy.types.Mesh, remarks: Remarks) -> None:
    """Select the vertices, and edges and faces that have all of theirs among them, and nothing else."""
    triangles, _loops = loop_triangles(mesh)
    faces = np.concatenate([remarks.flat, remarks.repeated, remarks.inward]).astype(np.int64)
    chosen = np.zeros(len(mesh.vertices), bool)
    for vertices in (remarks.welded, remarks.crowded, remarks.pinched, triangles[faces].ravel()):
        chosen[vertices] = True
    ends = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", ends)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.vertices.foreach_set("select", chosen)
    mesh.edges.foreach_set("select", chosen[ends.reshape(-1, 2)].all(axis=1))
    mesh.polygons.foreach_set("select", np.logical_and.reduceat(chosen[corners], starts))


CLASSES = (STORMFIELD_OT_select_faults,)
