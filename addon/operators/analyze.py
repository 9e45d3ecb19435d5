# SPDX-License-Identifier: GPL-3.0-or-later
"""Analyze at this Frame: fixed points, periodic orbits, separatrices and the graph they make, at the current λ."""

import bpy

from ..analysis.steps import ecg_steps
from ..scene.read.active_field import active_field
from ..scene.read.current_field import read_current, why_no_field
from ..scene.write import analysis_objects, timeline
from .job_operator import JobOperator


class AnalysisOperator(JobOperator):
    """Mix-in of operators that need a field on the mesh."""

    @classmethod
    def why_not(cls, obj: bpy.types.Object) -> str:
        return why_no_field(obj)


class STORMFIELD_OT_analyze(AnalysisOperator, bpy.types.Operator):
    """Find fixed points, periodic orbits, separatrices and their graph at the current λ. Esc stops"""

    bl_idname = "stormfield.analyze"
    bl_label = "Analyze at this Frame"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Analyzing"

    def start(self, context, obj):
        field = read_current(context, obj)
        self._attribute = field.attribute
        return ecg_steps(field.mesh, field.values, field.lam)

    def finish(self, context, obj, graph):
        analysis_objects.show_ecg(context.scene, obj, graph, self._attribute)
        obj.stormfield.analysis.shown = "ecg"
        points = sum(entity.curve is None for entity in graph.entities)
        orbits = len(graph.entities) - points
        weak = obj.stormfield.analysis.ecg.weak()
        hidden = f"; {weak} of them are weaker than the accuracy of the solve and hidden, see Detail" if weak else ""
        self.report(
            {"INFO"},
            f"'{obj.name}' at λ {graph.lam:.3f}: {_count(points, 'fixed point')}, {_count(orbits, 'periodic orbit')}, "
            f"{_count(len(graph.links), 'link')}{hidden}",
        )


class STORMFIELD_OT_forget_analysis(bpy.types.Operator):
    """Remove lists, graphs, markers and the collection of this object's analysis. The field stays"""

    bl_idname = "stormfield.forget_analysis"
    bl_label = "Remove Analysis"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        obj = active_field(context)
        made = obj is not None and any(obj.stormfield.analysis.list(which).made for which in ("ecg", "history", "mcg"))
        if not made:
            cls.poll_message_set("Nothing was analyzed yet")
        return made

    def execute(self, context):
        obj = active_field(context)
        timeline.remove_markers(obj)
        analysis_objects.forget(obj)
        return {"FINISHED"}


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


CLASSES = (STORMFIELD_OT_analyze, STORMFIELD_OT_forget_analysis)
