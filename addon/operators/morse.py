"""Morse sets of the shown field at the current λ: found, refined, simplified (thesis 6 to 8)."""

import bpy

from ..analysis.steps import MorseSets, morse_steps
from ..convert import analysis_objects
from ..convert.current_field import read_current
from . import morse_state
from .analyze import AnalysisOperator


class STORMFIELD_OT_morse_sets(AnalysisOperator, bpy.types.Operator):
    """Divide the surface into sets that hold all recurrence of the shown field at the current λ. Esc stops"""

    bl_idname = "stormfield.morse_sets"
    bl_label = "Morse Sets"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Dividing"

    def start(self, context, obj):
        field = read_current(context, obj)
        self._attribute = field.attribute
        return morse_steps(field.mesh, field.values, field.lam, **morse_state.options(obj.stormfield.morse))

    def finish(self, _context, obj, found):
        show(obj, found, self._attribute)
        obj.stormfield.morse.property_unset("simplify")
        sets, links = len(found.graph.entities), len(found.graph.links)
        self.report({"INFO"}, f"'{obj.name}' at λ {found.graph.lam:.3f}: {sets} Morse sets, {links} links")


def show(obj: bpy.types.Object, found: MorseSets, attribute: str) -> None:
    """Bring a decomposition to the object, and remember it for refinement and simplification."""
    analysis_objects.show_morse(obj, found.graph, found.decomposition.face_sets, attribute)
    obj.stormfield.analysis.shown = "mcg"
    morse_state.remember(obj, found, attribute)


CLASSES = (STORMFIELD_OT_morse_sets,)
