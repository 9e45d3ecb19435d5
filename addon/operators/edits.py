# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of the solved field: cancel a pair, cancel the weakest, simplify; and the list of those that were made.

An edit is tried on the sample that is nearest to the analyzed λ, then solved with all others, and analyzed. Only when
all of that went well it enters the list and the new field is shown; otherwise everything is as it was.
"""

import math
from dataclasses import replace
from functools import partial

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, IntProperty

from .. import native
from ..analysis.steps import ecg_steps, field_steps
from ..bake.edited import read_outcomes
from ..bake.lambda_cache import solve_steps
from ..cache.field_cache import open_cache
from ..cache.fields import ATTRIBUTE
from ..edits.proposals import pair_steps, weakest_steps
from ..model.edits import Edit, EntityAt, edits_from_json
from ..model.errors import InputError
from ..scene.read import folders
from ..scene.read.active_field import active_field
from ..scene.read.current_field import cache_of, surface_in
from ..scene.read.design import read_design
from ..scene.read.mesh import read_polygons
from ..scene.write import analysis_objects
from ..scene.write.edits import add_edit
from ..session import freshness, made_caches, solver_state
from ..work import Step, Steps, scaled
from . import solve
from .edit_choice import picked, why_not, why_not_cancel
from .shared import FieldOperator

#: Where the edit is proposed and where all is solved, in the fractions of all steps.
PROPOSED, SOLVED = 0.15, 0.9


class EditOperator(solve.SolvingOperator):
    """Mix-in of operators that add an edit."""

    job_title = "Editing"
    why_not = staticmethod(why_not)

    def propose(self, sample: "native.VectorField") -> Steps[dict]:
        """The members of the edit that are its own. Raises InputError where the core refuses it."""
        raise NotImplementedError

    def start(self, context, obj):
        """Everything of the scene is read here: the artist may go on while the steps work."""
        ecg = obj.stormfield.analysis.ecg
        self._lam, self._attribute = ecg.lam, ecg.shown_field
        self._known = [(item.name, EntityAt(item.kind, tuple(item.position))) for item in ecg.items]
        mesh, design = read_design(context, obj)
        root = folders.cache_root(obj)
        self._before = made_caches.existing(root)
        state = solver_state.of(obj) if obj.stormfield.solve.keep_solver else None
        solves = partial(solve_steps, mesh, root=root, polygons=read_polygons(obj), state=state)
        return self._edited(design, _Sample(obj, mesh, self._lam, self._attribute), solves)

    def finish(self, context, obj, result):
        folder, graph, edit = result
        before = len(obj.stormfield.analysis.ecg.items)
        add_edit(obj, edit, self._title(edit))
        self._read = freshness.read(obj)
        super().finish(context, obj, folder)
        analysis_objects.show_ecg(context.scene, obj, graph, self._attribute)
        left = len(graph.entities)
        self.report({"INFO"}, f"{obj.stormfield.edits[-1].name}: {before} entities before, {left} after")
        if left >= before:
            text = f"As many are left at λ {graph.lam:.3f}: the edit acts at the nearest sample, λ {edit.lam[0]:.3f}"
            self.report({"WARNING"}, text)

    def _edited(self, design, sample, solves):
        """Steps: (folder of the new λ cache, graph of its field, edit)."""
        _, field = yield from field_steps(sample.surface.mesh, sample.values)
        own = yield from scaled(self.propose(field), 0.0, PROPOSED)
        edit = _edit({**own, "lam": sample.lam, "reach": self.reach, "field": _field_of(design, self._attribute)})
        design = replace(design, edits=(*design.edits, edit))
        self._solves = sample.mesh, design
        folder = yield from scaled(solves(design), PROPOSED, SOLVED)
        outcome = read_outcomes(folder)[-1]
        if outcome.status == "refused":
            made_caches.note(folder, self._before)
            raise InputError(outcome.reason)
        values = open_cache(folder).at(self._lam)[self._attribute]
        analysis = ecg_steps(sample.surface.mesh, sample.surface.to_surface(values).astype(np.float64), self._lam)
        graph = yield from scaled(analysis, SOLVED, 1.0)
        return folder, graph, edit

    def _title(self, edit: Edit) -> str:
        return " and ".join(_name(self._known, entity) for entity in edit.entities)


class _Sample:
    """The field of the λ sample nearest to a λ, on the surface in an object's mesh."""

    def __init__(self, obj, mesh, lam: float, attribute: str):
        cache = cache_of(obj, mesh)
        number = int(np.argmin(np.abs(cache.lambdas - lam)))
        self.mesh, self.surface = mesh, surface_in(obj, mesh)
        self.values = self.surface.to_surface(cache.sample(number)[attribute]).astype(np.float64)
        self.lam = float(cache.lambdas[number])


def _edit(content: dict) -> Edit:
    return edits_from_json({"schema": "stormfield.edits/1", "edits": [content]})[0]


def _field_of(design, attribute: str) -> str:
    """Both where the fields are one, otherwise the one that was analyzed."""
    if all(element.field == "both" for element in design.elements):
        return "both"
    return next(name for name, its in ATTRIBUTE.items() if its == attribute)


def _name(known: list[tuple[str, EntityAt]], entity: EntityAt) -> str:
    """That of the nearest of its kind in the analysis, whose λ may lie beside the sample's."""
    alike = [(math.dist(other.at, entity.at), name) for name, other in known if other.kind == entity.kind]
    return min(alike)[1] if alike else entity.kind.title()


def _pair(pair: tuple[EntityAt, EntityAt]) -> dict:
    return {"type": "cancel", "entities": [{"kind": entity.kind, "at": list(entity.at)} for entity in pair]}


_REACH = {
    "name": "Reach",
    "description": "How far along λ the change fades out; 0 changes the nearest sample alone (0..1)",
    "subtype": "FACTOR",
    "min": 0.0,
    "max": 1.0,
    "default": 0.1,
}


class STORMFIELD_OT_cancel_pair(EditOperator, bpy.types.Operator):
    """Take away the two selected entities, or the selected one with the nearest that it can vanish with. Verified, or
    refused with the reason and nothing is changed. Esc stops"""

    bl_idname = "stormfield.cancel_pair"
    bl_label = "Cancel"
    bl_options = {"REGISTER", "UNDO"}
    why_not = staticmethod(why_not_cancel)

    reach: FloatProperty(**_REACH)

    def start(self, context, obj):
        items = [obj.stormfield.analysis.ecg.items[index] for index in picked(obj)]
        self._picked = [EntityAt(item.kind, tuple(item.position)) for item in items]
        return super().start(context, obj)

    def propose(self, sample):
        first, second = (*self._picked, None)[:2]
        return _pair((yield from pair_steps(sample, first, second)))


class STORMFIELD_OT_cancel_weakest(EditOperator, bpy.types.Operator):
    """Take away the pair of least persistence that can be cancelled at this λ. Repeat it to simplify step by step. Esc
    stops"""

    bl_idname = "stormfield.cancel_weakest"
    bl_label = "Cancel Weakest"
    bl_options = {"REGISTER", "UNDO"}

    reach: FloatProperty(**_REACH)

    def propose(self, sample):
        return _pair((yield from weakest_steps(sample)))


class STORMFIELD_OT_simplify(EditOperator, bpy.types.Operator):
    """Cancel pairs at this λ, the least persistent first, until so many fixed points and orbits are left. Esc stops"""

    bl_idname = "stormfield.simplify"
    bl_label = "Simplify"
    bl_options = {"REGISTER", "UNDO"}

    keep: IntProperty(
        name="Keep", description="Fixed points and periodic orbits that are left (count)", default=12, min=1
    )
    reach: FloatProperty(**_REACH)

    def start(self, context, obj):
        count = len(obj.stormfield.analysis.ecg.items)
        if count <= self.keep:
            raise InputError(f"The field has {count} fixed points and orbits; keep fewer than that")
        return super().start(context, obj)

    def propose(self, _sample):
        yield Step(0.0, "Simplifying")
        return {"type": "simplify", "keep": self.keep}

    def _title(self, edit):
        return f"Keep {edit.keep}"


class EditListOperator(FieldOperator):
    """Mix-in of operators on the active edit of the list."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if active_field(context).stormfield.chosen_edit() is None:
            cls.poll_message_set("Choose an edit in the list first")
            return False
        return True


class STORMFIELD_OT_remove_edit(EditListOperator, bpy.types.Operator):
    """Take the active edit out of the list; solve again to have the field without it"""

    bl_idname = "stormfield.remove_edit"
    bl_label = "Remove Edit"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        field = active_field(context).stormfield
        field.edits.remove(field.active_edit)
        field.active_edit = max(0, min(field.active_edit, len(field.edits) - 1))
        return {"FINISHED"}


class STORMFIELD_OT_move_edit(EditListOperator, bpy.types.Operator):
    """Move the active edit in the list; edits are applied from top to bottom at the next solve"""

    bl_idname = "stormfield.move_edit"
    bl_label = "Move Edit"
    bl_options = {"REGISTER", "UNDO"}

    direction: EnumProperty(items=(("UP", "Up", "Towards the top"), ("DOWN", "Down", "Towards the bottom")))

    def execute(self, context):
        field = active_field(context).stormfield
        goal = field.active_edit + (-1 if self.direction == "UP" else 1)
        if not 0 <= goal < len(field.edits):
            return {"CANCELLED"}
        field.edits.move(field.active_edit, goal)
        field.active_edit = goal
        return {"FINISHED"}


CLASSES = (
    STORMFIELD_OT_cancel_pair,
    STORMFIELD_OT_cancel_weakest,
    STORMFIELD_OT_simplify,
    STORMFIELD_OT_remove_edit,
    STORMFIELD_OT_move_edit,
)
