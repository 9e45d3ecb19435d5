# SPDX-License-Identifier: GPL-3.0-or-later
"""Modal operators driven by hand, without a window: the operator's own code on an object that stands in for it."""

from types import SimpleNamespace

import bpy
from stormfield.operators import job_operator

TIMER, ESC = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")


def in_slices(operator, *, stop_after=None, messages=None, reports=None, slice_seconds=None, **properties):
    """What the operator ends with in a window; Esc after that many slices. messages, reports: lists that get them.
    slice_seconds: 0 is one step a slice."""
    own = {name: value for name, value in vars(operator).items() if callable(value) or name in ("job_title", "READ")}
    said = [] if reports is None else reports
    own["report"] = lambda _self, _kind, text: said.append(text)
    defaults = {name: keywords.keywords.get("default", "") for name, keywords in operator.__annotations__.items()}
    work = type("Work", (job_operator.JobOperator,), own | defaults | properties)()
    context = _context()
    before, job_operator.SLICE = job_operator.SLICE, job_operator.SLICE if slice_seconds is None else slice_seconds
    try:
        return _driven(work, context, stop_after, messages if messages is not None else [])
    finally:
        job_operator.SLICE = before


def _driven(work, context, stop_after, messages):
    from stormfield.session import running

    end, slices = work._begin(context), 0
    while end in ({"RUNNING_MODAL"}, {"PASS_THROUGH"}):
        end = work.modal(context, ESC if slices == stop_after else TIMER)
        slices += 1
        if running.current() is not None:
            messages.append(running.current().message)
    return end


def _context():
    """The real scene, with a window manager that has no window."""
    manager = SimpleNamespace(
        **{name: lambda *_, **__: None for name in ("progress_begin", "progress_update", "progress_end")},
        **{name: lambda *_, **__: None for name in ("event_timer_add", "event_timer_remove", "modal_handler_add")},
        windows=[],
    )

    class Context:
        window_manager, window = manager, None
        workspace = SimpleNamespace(status_text_set=lambda _: None)

        def __getattr__(self, name):
            return getattr(bpy.context, name)

    return Context()
