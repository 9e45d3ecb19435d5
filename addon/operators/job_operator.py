# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work without a blocked window: a generator of steps, driven in short slices by a timer.

    class SOLVE(JobOperator, Operator):
        job_title = "Solving"
        why_not = staticmethod(why_not)  # object -> why it cannot be done now, and the cure; "" when it can
        def start(self, context, obj):  -> generator that yields steps with .fraction and .message, returns its result
        def finish(self, context, obj, result):  attaches what was made, to a new object where subject() gives None
        keeps_when_stopped = True  # where Esc shall leave what is complete, instead of nothing

With a window the operator is modal: slices of SLICE seconds, progress in the status bar, the cursor and the panel, Esc
ends it within a tenth of a second. Without (background mode, scripts) the same generator runs to its end in one call.
Between slices the object is known by its session uid only, so undo, renaming and deletion in the meantime do no harm.
"""

import time

import bpy

from ..scene.read.active_field import active_field
from ..session import running
from ..work import Stop
from .shared import FieldOperator, redraw_sidebars, report_fault

#: Seconds of work in one slice, and between two timer events.
SLICE = 0.04
TICK = 0.02
#: Faults of input, solver, disk and memory, reported to the artist. All others are our mistakes and go to the console.
EXPECTED = (ValueError, RuntimeError, OSError, MemoryError)


class JobOperator(FieldOperator):
    job_title = "Working"
    #: Whether work that is stopped is asked to end early, and finish() gets what is complete.
    keeps_when_stopped = False
    _shown = ""
    _ending = False
    #: Whether execute() comes from what invoke() asked.
    _asked = False

    @classmethod
    def poll(cls, context):
        job = running.current()
        if job is not None:
            cls.poll_message_set(f"{job.title} '{job.object_name}'; press Esc to stop it")
            return False
        if not super().poll(context):
            return False
        reason = cls.why_not(active_field(context))
        if reason:
            cls.poll_message_set(reason)
        return not reason

    @staticmethod
    def why_not(obj: bpy.types.Object) -> str:
        """Why the work cannot begin now, and the cure; empty when it can."""
        return ""

    def subject(self, context):
        """The object that the work is for; None where finish() makes one."""
        return active_field(context)

    def new_name(self):
        """What work without an object is called."""
        return ""

    def was_stopped(self, name: str) -> set[str]:
        """Say what is left after the work for the object of that name was stopped before it had a result."""
        self.report({"WARNING"}, f"{self.job_title} '{name}' was stopped; it is as it was before")
        return {"CANCELLED"}

    def execute(self, context):
        """The whole work in one call; in slices where a file browser or a dialog of this operator ends with it."""
        if self._asked:
            self._asked = False
            return self._begin(context)
        obj = self.subject(context)
        self._job = running.begin(self.job_title, obj, self.new_name())
        try:
            steps = self.start(context, obj)
            while True:
                step = self._take(next(steps))
                if step.waiting:
                    time.sleep(TICK)
        except StopIteration as end:
            running.end()
            return self._finished(context, end.value)
        except EXPECTED as fault:
            return report_fault(self, fault)
        finally:
            running.end()

    # In slices --------------------------------------------------------------------------------------------------------

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        return self._begin(context)

    def ask(self, asking):
        """asking: what the call that opens a file browser or a dialog returned. What it ends with runs in slices."""
        self._asked = not bpy.app.background
        return asking

    def _begin(self, context):
        fault = self.begin(context)
        if not fault:
            context.window_manager.modal_handler_add(self)
        return fault or {"RUNNING_MODAL"}

    def begin(self, context) -> set[str]:
        """Start the work, which modal() goes on with; what the operator returns where it cannot start."""
        obj = self.subject(context)
        self._steps, self._shown, self._ending = None, "", False
        try:
            self._steps = self.start(context, obj)
        except EXPECTED as fault:
            return report_fault(self, fault)
        self._job = running.begin(self.job_title, obj, self.new_name())
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK, window=context.window)
        return set()

    def modal(self, context, event):
        if self._is_stopped_by(event):
            if self._ending or not self.keeps_when_stopped or running.current() is None:
                return self._stopped(context)
            return self._work(context, self._end_early)
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        return self._work(context, self._run_slice)

    def cancel(self, context):
        """Blender ends modal operators when a file is loaded or the window closes."""
        self._leave(context)

    def _is_stopped_by(self, event) -> bool:
        job = running.current()
        return job is None or job.cancel_requested or (event.type == "ESC" and event.value == "PRESS")

    def _work(self, context, advance):
        """advance() takes steps; when the steps end, the operator ends."""
        try:
            advance()
        except StopIteration as end:
            self._leave(context)
            return self._finished(context, end.value)
        except Stop:  # there is nothing yet
            return self._stopped(context)
        except EXPECTED as fault:
            self._leave(context)
            return report_fault(self, fault)
        except BaseException:
            self._leave(context)
            raise
        self._show(context)
        return {"PASS_THROUGH"}

    def _run_slice(self):
        until = time.monotonic() + SLICE
        while True:
            step = self._take(next(self._steps))
            if step.waiting or time.monotonic() >= until:  # the core works on its own threads: give the time back
                break

    def _end_early(self):
        """Ask the steps to end with what is complete; a second Esc stops them at once."""
        self._ending, self._job.cancel_requested = True, False
        self._take(self._steps.throw(Stop()))
        self._run_slice()

    def _take(self, step):
        self._job.fraction, self._job.message = step.fraction, step.message
        for note in step.notes:
            self.report({"WARNING"}, note)
        return step

    def _show(self, context):
        """Progress in the status bar, the cursor and the panel, when what they say has changed."""
        job = self._job
        text = f"{self.job_title} '{job.object_name}': {job.fraction:.0%}  {job.message}      Esc: stop"
        if text != self._shown:
            self._shown = text
            context.window_manager.progress_update(round(job.fraction * 100))
            context.workspace.status_text_set(text)
            redraw_sidebars(context)

    # The end ----------------------------------------------------------------------------------------------------------

    def _stopped(self, context):
        self._leave(context)
        return self.was_stopped(self._job.object_name)

    def _finished(self, context, result):
        obj = self._job.object()
        if self._job.has_lost_object:
            self.report({"WARNING"}, f"'{self._job.object_name}' was deleted meanwhile; its cache is kept")
            return {"CANCELLED"}
        try:
            self.finish(context, obj, result)
        except EXPECTED as fault:
            return report_fault(self, fault)
        return {"FINISHED"}

    def _leave(self, context):
        """Stop the generator (it cleans up after itself) and give window, cursor and status bar back."""
        if self._steps is not None:
            self._steps.close()
            self._steps = None
        running.end()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        redraw_sidebars(context)


class STORMFIELD_OT_cancel_job(bpy.types.Operator):
    """Stop the solve or bake that is running (the same as Esc)"""

    bl_idname = "stormfield.cancel_job"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context):
        return running.current() is not None

    def execute(self, _context):
        running.request_cancel()
        return {"FINISHED"}


CLASSES = (STORMFIELD_OT_cancel_job,)
