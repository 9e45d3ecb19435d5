# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a fixed point: drag it over the surface, or give the place by numbers."""

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, StringProperty
from bpy_extras import view3d_utils

from ..edits.trial import MoveTrial
from ..model.edits import EntityAt
from ..model.errors import InputError
from ..scene.read.active_field import active_field
from ..scene.read.mesh import read_mesh
from ..scene.read.places import Places
from ..scene.read.sample import Sample
from ..scene.read.seen_surface import SeenSurface, is_changed
from ..session import edit_ghost, objects
from ..session.edit_ghost import Ghost
from ..work import Step, run
from .edit_choice import why_not_move
from .edit_operator import REACH, EditOperator
from .job_operator import TICK
from .shared import report_fault

HELP = "Move the dot      Click: apply      Esc, right click: leave it where it is"


class STORMFIELD_OT_move_point(EditOperator, bpy.types.Operator):
    """Drag the selected fixed point over the surface; all else that the analysis shows stays. The faces that would
    change are shown, red where the point cannot go. Verified, or refused with the reason and nothing is changed"""

    bl_idname = "stormfield.move_point"
    bl_label = "Move Point"
    bl_options = {"REGISTER", "UNDO"}
    why_not = staticmethod(why_not_move)

    to: FloatVectorProperty(
        name="To",
        description="Where the point shall be, in the object's space (mesh units)",
        subtype="XYZ",
        options={"SKIP_SAVE"},
    )
    reach: FloatProperty(**REACH)
    held: BoolProperty(
        name="Held", description="The button is down: its release applies", options={"HIDDEN", "SKIP_SAVE"}
    )
    kind: StringProperty(name="Kind", description="Of the point that is moved", options={"HIDDEN", "SKIP_SAVE"})
    place: FloatVectorProperty(
        name="From", description="A place near the point that is moved (mesh units)", options={"HIDDEN", "SKIP_SAVE"}
    )

    _trial: MoveTrial | None = None

    def start(self, context, obj):
        if not self.properties.is_property_set("to"):
            raise InputError("Give the place where the point shall be")
        self._take_selected(obj)
        return super().start(context, obj)

    def propose(self, _sample):
        yield Step(0.0, "Moving the point")
        entity = {"kind": self.kind, "at": list(self.place)}
        return {"type": "move", "entity": entity, "to": list(self.to), "reach": self.reach}

    def title(self, edit):
        return f"Move {super().title(edit)}"

    # Dragging ---------------------------------------------------------------------------------------------------------

    def invoke(self, context, event):
        by_numbers = self.properties.is_property_set("to")
        if bpy.app.background or by_numbers or context.region_data is None:
            return super().invoke(context, event)
        obj = active_field(context)
        self._take_selected(obj)
        try:
            sample = Sample(obj, read_mesh(obj), obj.stormfield.lam, obj.stormfield.look.shown_field)
            self._trial = MoveTrial(run(sample.field()), EntityAt(self.kind, tuple(self.place)))
        except (ValueError, RuntimeError, OSError) as fault:
            return report_fault(self, fault)
        self._uid, self._spot = obj.session_uid, None
        self._dragging = context.window_manager.event_timer_add(TICK, window=context.window)
        context.workspace.status_text_set(HELP)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if self._trial is None:
            return super().modal(context, event)
        obj = objects.find(self._uid)
        if obj is None or event.type in {"ESC", "RIGHTMOUSE"}:
            self._end_drag(context)
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            self._aim(context, obj, event)
        elif event.type == "TIMER":
            return self._follow(context, obj)
        elif self._is_confirmed(event):
            return self._apply(context)
        else:
            return {"PASS_THROUGH"}  # the view can be turned
        return {"RUNNING_MODAL"}

    def _is_confirmed(self, event) -> bool:
        """A click, or the release of the button that holds the dot."""
        if event.type == "LEFTMOUSE":
            return event.value == ("RELEASE" if self.held else "PRESS")
        return event.type in {"RET", "NUMPAD_ENTER"} and event.value == "PRESS"

    def cancel(self, context):
        if self._trial is not None:
            self._end_drag(context)
        else:
            super().cancel(context)

    def _take_selected(self, obj) -> None:
        """The selected point, unless the redo panel says which."""
        if not self.properties.is_property_set("kind"):
            item = obj.stormfield.analysis.ecg.selected()
            self.kind, self.place = item.kind, item.position

    def _aim(self, context, obj, event) -> None:
        spot = _under(context, obj, (event.mouse_region_x, event.mouse_region_y))
        if spot is not None:
            self._spot = spot
            self._trial.aim(spot)
            self._show_ghost(obj)

    def _follow(self, context, obj):
        try:
            if self._trial.poll():
                self._show_ghost(obj)
        except InputError as fault:
            self._end_drag(context)
            return report_fault(self, fault)
        tried = self._trial.result
        context.workspace.status_text_set(f"{tried.reason}      {HELP}" if tried and tried.reason else HELP)
        return {"RUNNING_MODAL"}

    def _show_ghost(self, obj) -> None:
        """The ghost of the last place that was tried, and the dot under the pointer."""
        tried = self._trial.result
        if tried is None:
            edit_ghost.show(obj, Ghost(place=self._spot, kind=self.kind))
            return
        current = self._spot is not None and np.allclose(tried.place, self._spot)
        allowed = tried.allowed if current else None
        edit_ghost.show(obj, Ghost(tried.faces, self._spot, self.kind, allowed, tried.reason))

    def _apply(self, context):
        self._end_drag(context)
        if self._spot is None:
            return {"CANCELLED"}
        self.to = self._spot
        return self.begin(context) or {"RUNNING_MODAL"}

    def _end_drag(self, context) -> None:
        self._trial.close()
        self._trial = None
        context.window_manager.event_timer_remove(self._dragging)
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        obj = objects.find(self._uid)
        if obj is not None:
            edit_ghost.show(obj, None)


def _under(context, obj, pointer) -> np.ndarray | None:
    """The point of the object's surface at rest that is seen under the pointer (pixels of the region)."""
    evaluated = obj.evaluated_get(context.view_layer.depsgraph)
    inverse = evaluated.matrix_world.inverted_safe()
    origin = view3d_utils.region_2d_to_origin_3d(context.region, context.region_data, pointer)
    towards = view3d_utils.region_2d_to_vector_3d(context.region, context.region_data, pointer)
    start, along = inverse @ origin, inverse.to_3x3() @ towards
    hit, place, _normal, _face = evaluated.ray_cast(start, along.normalized())
    if not hit:
        return None
    seen = np.array(place)
    if not is_changed(obj):
        return seen
    with Places(context) as places:
        return SeenSurface(places, obj).line_at_rest(seen[None])[0]


CLASSES = (STORMFIELD_OT_move_point,)
