# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer Field: bring the field over to a mesh whose faces have changed, until it is solved again."""

import bpy

from ..bake.transfer import transfer_steps
from ..cache.field_cache import open_cache
from ..scene.read import folders
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.mesh import read_mesh, read_polygons
from ..scene.write import attach, mesh_edits
from . import requirements
from .job_operator import JobOperator


def why_not(obj: bpy.types.Object) -> str:
    """Why there is nothing to bring over, and the cure; empty when there is."""
    if attached_folder(obj, LAMBDA) is None:
        return "Solve first: there is no field yet"
    if not mesh_edits.is_paused(obj):
        return "The field belongs to this mesh; nothing has to be brought over"
    return requirements.problem()


class STORMFIELD_OT_transfer_field(JobOperator, bpy.types.Operator):
    """Bring the field over to the edited mesh, from the closest points of the mesh that was solved, until you solve
    again"""

    bl_idname = "stormfield.transfer_field"
    bl_label = "Transfer Field"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Transferring"
    why_not = staticmethod(why_not)

    def start(self, _context, obj):
        cache = open_cache(attached_folder(obj, LAMBDA))
        return transfer_steps(cache, read_mesh(obj), folders.cache_root(obj), read_polygons(obj))

    def finish(self, _context, obj, folder):
        attach.show_solved(obj, folder)
        self.report({"INFO"}, f"'{obj.name}' has its field on the edited mesh, approximately; solve again when done")


CLASSES = (STORMFIELD_OT_transfer_field,)
