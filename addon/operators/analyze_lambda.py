# SPDX-License-Identifier: GPL-3.0-or-later
"""Follow over Time (λ): every fixed point followed through all samples of the cache, and their bifurcations."""

import bpy

from ..analysis.steps import tracking_steps
from ..scene.read.active_field import active_field
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.current_field import cache_of
from ..scene.read.lambda_source import varies
from ..scene.read.mesh import read_mesh
from ..scene.write import analysis_objects, timeline
from .analyze import AnalysisOperator
from .shared import FieldOperator


class STORMFIELD_OT_analyze_lambda(AnalysisOperator, bpy.types.Operator):
    """Follow every fixed point of the shown field over λ; where some appear, meet or vanish (bifurcations) the timeline
    gets a marker. Esc stops"""

    bl_idname = "stormfield.analyze_lambda"
    bl_label = "Follow over Time (λ)"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Following"

    @classmethod
    def why_not(cls, obj):
        if obj.mode == "EDIT":
            return "Leave Edit Mode first"
        if attached_folder(obj, LAMBDA) is None:
            return "Solve first: fixed points are followed through the samples of the λ cache"
        return ""

    def start(self, _context, obj):
        mesh = read_mesh(obj)
        self._attribute = obj.stormfield.look.shown_field
        return tracking_steps(cache_of(obj, mesh), mesh, self._attribute, obj.stormfield.analysis.persistence)

    def finish(self, context, obj, tracking):
        hidden = analysis_objects.show_tracking(context.scene, obj, tracking, self._attribute)
        obj.stormfield.analysis.shown = "history"
        markers = timeline.update_markers(obj)
        events = len(tracking.bifurcations)
        report = f"'{obj.name}': {len(tracking.paths)} paths, {events} bifurcations, {markers} timeline markers"
        if hidden:
            report += f"; {hidden} short-lived paths are hidden, see Filter"
        weak = obj.stormfield.analysis.history.weak()
        if weak:
            report += f"; {weak} weak ones are hidden, see Detail"
        if events and not varies(obj):
            report += "; key λ to get markers"
        self.report({"INFO"}, report)


class STORMFIELD_OT_update_markers(FieldOperator, bpy.types.Operator):
    """Put the timeline markers of bifurcations where λ passes them now; your own markers stay"""

    bl_idname = "stormfield.update_markers"
    bl_label = "Update Timeline Markers"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        obj = active_field(context)
        if not obj.stormfield.analysis.history.made:
            cls.poll_message_set("Follow over Time (λ) first")
            return False
        if not varies(obj):
            cls.poll_message_set("Key λ first: markers need a λ for each frame")
            return False
        return True

    def execute(self, context):
        self.report({"INFO"}, f"{timeline.update_markers(active_field(context))} timeline markers")
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_analyze_lambda, STORMFIELD_OT_update_markers)
