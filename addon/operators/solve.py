# SPDX-License-Identifier: GPL-3.0-or-later
"""Solve: read the scene, solve over mesh × λ, write the λ cache and attach it to the object."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import bpy

from ..analysis.doubts import doubts_of
from ..bake.lambda_cache import solve_steps
from ..cache.fields import on_surface
from ..model.design import Design, SolveSettings
from ..model.mesh_data import MeshData
from ..scene.read import folders
from ..scene.read.design import read_design
from ..scene.read.mesh import read_polygons
from ..scene.write import attach, doubts
from ..scene.write.edits import show_outcomes
from ..session import found_caches, freshness, made_caches, solver_state
from ..solve import SolverState
from ..work import Steps
from . import requirements
from .doubts import solved_fields
from .job_operator import JobOperator


def why_not(obj: bpy.types.Object) -> str:
    """Why the field cannot be solved now, and the cure; empty when it can."""
    if not any(element.enabled for element in obj.stormfield.elements):
        return "Add an element first: draw on the surface, or add a curve or an empty"
    return requirements.problem()


def kept_of(obj: bpy.types.Object) -> dict:
    """What the last solve left for the next one: arguments of solve_steps."""
    if not obj.stormfield.solve.keep_solver:
        return {}
    return {"state": solver_state.of(obj), "reuse": solver_state.reuse_of(obj)}


class SolvingOperator(JobOperator):
    """Mix-in of operators that solve a field and show it."""

    job_title = "Solving"
    why_not = staticmethod(why_not)

    def start(self, context, obj):
        mesh, design = self._solves = read_design(context, obj)
        self._read = freshness.read(obj)
        return self.solver(obj, mesh, design.settings)(design)

    def solver(self, obj, mesh: MeshData, settings: SolveSettings) -> Callable[[Design], Steps[Path]]:
        """What gives the steps that solve a design with these settings into the object's caches."""
        kept = kept_of(obj)
        self._surface = (kept.get("state") or SolverState()).surface_of(mesh, settings)
        root = folders.cache_root(obj)
        self._before = made_caches.existing(root)
        return partial(solve_steps, mesh, root=root, polygons=read_polygons(obj), surface=self._surface, **kept)

    def finish(self, _context, obj, folder):
        attach.show_solved(obj, folder)
        show_outcomes(obj, folder)
        freshness.keep(obj, self._read)
        found_caches.forget(obj)
        made_caches.note(folder, self._before)
        made_caches.delete_superseded()
        self._tell_doubts(obj)

    def _tell_doubts(self, obj):
        """Keep for the panel, and say, what the artist should know of the result."""
        mesh, design = self._solves
        surface = self._surface.manifold
        fields = on_surface(solved_fields(obj, mesh), surface)
        found = doubts_of(self._surface.coarse, design, fields, surface.remarks)
        doubts.keep(obj, found)
        for doubt in doubts.read(obj):
            if doubt.kind not in {"no_element", "faults"}:  # which the solver has told already
                self.report({"WARNING"}, doubt.text)


class STORMFIELD_OT_solve(SolvingOperator, bpy.types.Operator):
    """Solve the field for every λ, cache it and show it on the mesh. Esc stops"""

    bl_idname = "stormfield.solve"
    bl_label = "Solve"
    bl_options = {"REGISTER", "UNDO"}

    def finish(self, context, obj, folder):
        super().finish(context, obj, folder)
        self.report({"INFO"}, f"'{obj.name}' is solved; move λ or scrub the timeline to see it")


CLASSES = (STORMFIELD_OT_solve,)
