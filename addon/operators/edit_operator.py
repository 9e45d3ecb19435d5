# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators that add an edit share.

An edit is tried on the sample that is nearest to the shown λ, then applied with all others, and analyzed. Only when all
of that went well it enters the list and the new field is shown; otherwise everything is as it was.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..analysis.entities import EntityGraph
from ..analysis.steps import ecg_steps
from ..bake.edited import read_outcomes
from ..bake.edited_given import edited_given_steps
from ..cache.field_cache import open_cache
from ..cache.fields import ATTRIBUTE
from ..model.design import Design
from ..model.edits import Edit, EntityAt, edits_from_json
from ..model.errors import InputError
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.current_field import is_given
from ..scene.read.design import read_design
from ..scene.read.freshness import edits_digests
from ..scene.read.mesh import read_polygons
from ..scene.read.sample import Sample
from ..scene.write import analysis_objects, attach
from ..scene.write.edits import add_edit, show_outcomes
from ..session import found_caches, freshness, made_caches, solver_state
from ..work import Steps, scaled
from . import solve
from .edit_choice import why_not_field

#: Where the edit is proposed and where all is solved, in the fractions of all steps.
PROPOSED, SOLVED = 0.15, 0.9

REACH = {
    "name": "Reach",
    "description": "How far along λ the change fades out; 0 changes the nearest sample alone (0..1)",
    "subtype": "FACTOR",
    "min": 0.0,
    "max": 1.0,
    "default": 0.1,
}


class EditOperator(solve.SolvingOperator):
    """Mix-in of operators that add an edit. They need a solved field; where its graph is shown, it is made again."""

    job_title = "Editing"
    why_not = staticmethod(why_not_field)

    def propose(self, sample: Sample) -> Steps[dict]:
        """The members of the edit that are its own. Raises InputError where the core refuses it."""
        raise NotImplementedError

    def title(self, edit: Edit) -> str:
        """What the list calls it."""
        return " and ".join(_name(self._known, entity) for entity in edit.entities)

    def drawn(self) -> dict[str, object]:
        """Members of the list's entry that the edit does not tell."""
        return {}

    def start(self, context, obj):
        """Everything of the scene is read here: the artist may go on while the steps work."""
        ecg, field = obj.stormfield.analysis.ecg, obj.stormfield
        self._attribute = field.look.shown_field
        self._analysis = (ecg.lam, ecg.shown_field) if ecg.made else None
        self._known = [(item.name, EntityAt(item.kind, tuple(item.position))) for item in ecg.items]
        mesh, design = read_design(context, obj)
        self._given = is_given(obj)
        solves = given_solves(obj, mesh) if self._given else self.solver(obj, mesh, design.settings)
        return self._edited(design, Sample(obj, mesh, field.lam, self._attribute), solves)

    def finish(self, context, obj, result):
        folder, graph, edit = result
        before = len(obj.stormfield.analysis.ecg.items)
        add_edit(obj, edit, self.title(edit), **self.drawn())
        if self._given:
            show_given(obj, folder)
        else:
            self._read = freshness.read(obj)
            super().finish(context, obj, folder)
        name = obj.stormfield.edits[-1].name
        if graph is None or self._analysis is None:
            self.report({"INFO"}, f"{name}: done")
            return
        analysis_objects.show_ecg(context.scene, obj, graph, self._analysis[1])
        self.report({"INFO"}, f"{name}: {before} entities before, {len(graph.entities)} after")
        self.tell(edit, graph, before)

    def tell(self, edit: Edit, graph: EntityGraph, before: int) -> None:
        """What else the artist should know of the graph after the edit."""

    def _edited(self, design, sample: Sample, solves):
        """Steps: (folder of the new λ cache, graph of its field where one is shown, edit)."""
        own = yield from scaled(self.propose(sample), 0.0, PROPOSED)
        edit = make_edit({"lam": sample.lam, "field": field_of(design, self._attribute), **own})
        design = replace(design, edits=(*design.edits, edit))
        self._solves = sample.mesh, design
        folder = yield from scaled(solves(design), PROPOSED, SOLVED)
        outcome = read_outcomes(folder)[-1]
        if outcome.status == "refused":
            if not self._given:
                made_caches.note(folder, self._before)
            raise InputError(outcome.reason)
        if self._analysis is None:
            return folder, None, edit
        lam, attribute = self._analysis
        values = open_cache(folder).at(lam)[attribute]
        analysis = ecg_steps(sample.surface.mesh, sample.surface.to_surface(values).astype(np.float64), lam)
        graph = yield from scaled(analysis, SOLVED, 1.0)
        return folder, graph, edit


def given_solves(obj, mesh) -> Callable[[Design], Steps[Path]]:
    """What applies the edits of a design to the given field of an object."""
    folder, polygons = Path(attached_folder(obj, LAMBDA)), read_polygons(obj)
    memory = solver_state.reuse_of(obj).edits if obj.stormfield.solve.keep_solver else None
    return lambda design: edited_given_steps(folder, mesh, design.edits, polygons, memory)


def show_given(obj, folder: Path) -> None:
    """Attach the edited cache of a given field, and remember the edits that it has."""
    attach.show_solved(obj, folder)
    show_outcomes(obj, folder)
    obj.stormfield.edited = ",".join(edits_digests(obj))
    found_caches.forget(obj)


def make_edit(content: dict) -> Edit:
    return edits_from_json({"schema": "stormfield.edits/1", "edits": [content]})[0]


def field_of(design, attribute: str) -> str:
    """Both where the fields are one, otherwise the one that was analyzed."""
    if all(element.field == "both" for element in design.elements):
        return "both"
    return next(name for name, its in ATTRIBUTE.items() if its == attribute)


def _name(known: list[tuple[str, EntityAt]], entity: EntityAt) -> str:
    """That of the nearest of its kind in the analysis, whose λ may lie beside the sample's."""
    alike = [(math.dist(other.at, entity.at), name) for name, other in known if other.kind == entity.kind]
    return min(alike)[1] if alike else entity.kind.title()
