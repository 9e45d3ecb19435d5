# SPDX-License-Identifier: GPL-3.0-or-later
"""Morse sets of the shown field at the current λ: found, refined, simplified (thesis 6 to 8)."""

import bpy

from ..analysis.steps import MorseSets, morse_steps, refine_set_steps
from ..scene.read.bake_task import read_morse_settings
from ..scene.read.current_field import read_current
from ..scene.write import analysis_objects
from ..session import morse_state
from .analyze import AnalysisOperator


class STORMFIELD_OT_morse_sets(AnalysisOperator, bpy.types.Operator):
    """Divide the surface into regions that hold all that comes back to where it was (Morse sets), at the current λ. Esc
    stops"""

    bl_idname = "stormfield.morse_sets"
    bl_label = "Find Regions"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Dividing"

    def start(self, context, obj):
        field = read_current(context, obj)
        self._attribute = field.attribute
        return morse_steps(field.mesh, field.values, field.lam, **read_morse_settings(obj).options())

    def finish(self, _context, obj, found):
        show(obj, found, self._attribute)
        obj.stormfield.morse.property_unset("simplify")
        sets, links = len(found.graph.entities), len(found.graph.links)
        self.report({"INFO"}, f"'{obj.name}' at λ {found.graph.lam:.3f}: {sets} regions, {links} links")


class STORMFIELD_OT_refine_morse(AnalysisOperator, bpy.types.Operator):
    """Divide coarse regions (Morse sets) further, at the current λ: Directions by ever smaller pieces of edges, also
    inside faces, the others by ever larger τ. Esc keeps what is done so far"""

    bl_idname = "stormfield.refine_morse"
    bl_label = "Refine"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Refining"
    keeps_when_stopped = True

    def start(self, context, obj):
        field = read_current(context, obj)
        self._attribute = field.attribute
        options = morse_state.refine_options(obj.stormfield.morse, field.mesh, field.values)
        return morse_steps(field.mesh, field.values, field.lam, **options)

    def finish(self, _context, obj, found):
        show(obj, found, self._attribute)
        ended = {
            "time": "; the time was up",
            "memory": "; the memory for it was used up",
            "cancelled": "; it was stopped, and what is divided so far is kept",
        }.get(found.decomposition.stop, "")
        self.report({"INFO"}, f"'{obj.name}': {len(found.graph.entities)} regions after refinement{ended}")


class STORMFIELD_OT_refine_set(AnalysisOperator, bpy.types.Operator):
    """Divide the selected region (Morse set) further; the others stay as they are. Esc stops"""

    bl_idname = "stormfield.refine_set"
    bl_label = "Refine this Region"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Refining"

    @classmethod
    def why_not(cls, obj):
        return morse_state.why_set_stays(obj)

    def start(self, _context, obj):
        state = morse_state.of(obj)
        entities = obj.stormfield.analysis.mcg
        self._attribute, self._before = state.attribute, len(entities.items)
        self._name = entities.selected().name
        return refine_set_steps(state.found, entities.active)

    def finish(self, _context, obj, found):
        more = len(found.graph.entities) - self._before
        if more == 0:
            self.report({"INFO"}, f"{self._name} stays one region, however far it is refined")
            return
        show(obj, found, self._attribute)
        self.report({"INFO"}, f"{self._name} is divided: {len(found.graph.entities)} regions, {more} more than before")


def show(obj: bpy.types.Object, found: MorseSets, attribute: str) -> None:
    """Bring a decomposition to the object, and remember it for refinement and simplification."""
    analysis_objects.show_morse(obj, found.graph, found.decomposition.face_sets, attribute)
    obj.stormfield.analysis.shown = "mcg"
    morse_state.remember(obj, found, attribute)


CLASSES = (STORMFIELD_OT_morse_sets, STORMFIELD_OT_refine_morse, STORMFIELD_OT_refine_set)
