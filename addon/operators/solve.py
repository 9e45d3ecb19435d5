"""Solve: read the scene, solve over mesh × λ, write the λ cache and attach it to the object."""

import bpy

from ..bake.job import solve_steps
from ..convert import attach, folders
from ..convert.mesh_arrays import read_polygons
from ..convert.scene import read_design
from . import requirements, solver_memory
from .job_operator import JobOperator


def why_not(obj: bpy.types.Object) -> str:
    """Why the field cannot be solved now, and the cure; empty when it can."""
    if not any(element.enabled for element in obj.stormfield.elements):
        return "Add an element first: draw on the surface, or add a curve or an empty"
    return requirements.problem()


class STORMFIELD_OT_solve(JobOperator, bpy.types.Operator):
    """Solve the field for every λ, cache it and show it on the mesh. Esc stops"""

    bl_idname = "stormfield.solve"
    bl_label = "Solve"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Solving"
    why_not = staticmethod(why_not)

    def start(self, context, obj):
        mesh, design = read_design(context, obj)
        memory = solver_memory.of(obj) if obj.stormfield.solve.keep_solver else None
        return solve_steps(mesh, design, folders.cache_root(obj), read_polygons(obj), memory=memory)

    def finish(self, context, obj, folder):
        attach.attach_lambda(obj, folder)
        folders.delete_old_caches(folder.parent, "lambda")
        self.report({"INFO"}, f"'{obj.name}' is solved; move λ or scrub the timeline to see it")


CLASSES = (STORMFIELD_OT_solve,)
