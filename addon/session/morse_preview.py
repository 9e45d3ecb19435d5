# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse Morse sets, at once, whenever λ or a setting of the Morse panel changes.

The work runs on the core's threads and is watched by a timer; a new request cancels the running one. What is found is
drawn and never written to the file, so that scrubbing leaves nothing to undo. For speed τ is never longer than the
starting value that mesh and field suggest. Previews are known by the session uid of their object.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .. import native
from ..analysis.mcg import morse_graph
from ..analysis.steps import native_field
from ..model.manifold import Manifold
from ..scene.read.bake_task import read_morse_settings
from ..scene.read.current_field import read_current
from ..scene.write.selection import redraw
from . import morse_state, objects, running

#: Seconds between two checks of the work, and that a setting must stay the same before work begins.
TICK, PAUSE = 0.03, 0.08


@dataclass
class Preview:
    sets: np.ndarray  #: (m,) per triangle of the object's mesh, -1 for none
    kinds: list[str]
    lam: float
    version: int


@dataclass
class _Work:
    job: native.MorseJob
    surface: native.TriangleMesh
    taken: Manifold  #: how it belongs to the object's mesh
    lam: float


_previews: dict[int, Preview] = {}
_requested: set[int] = set()
_work: dict[int, _Work] = {}
_count = 0


def of(obj: bpy.types.Object) -> Preview | None:
    return _previews.get(obj.session_uid) if obj.stormfield.morse.live else None


def request(obj: bpy.types.Object) -> None:
    """Make the preview of an object soon. Without a window, at once."""
    if bpy.app.background:
        _begin(obj)
        while _work:
            _work[obj.session_uid].job.wait()
            _collect_results()
        return
    _requested.add(obj.session_uid)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=PAUSE)


def follow(obj: bpy.types.Object) -> None:
    """Make the preview again when λ has changed since."""
    known = _work.get(obj.session_uid) or _previews.get(obj.session_uid)
    if known is None or abs(known.lam - obj.stormfield.lam) > 1e-6:
        request(obj)


def stop(obj: bpy.types.Object) -> None:
    _requested.discard(obj.session_uid)
    _cancel(obj.session_uid)
    _previews.pop(obj.session_uid, None)


def forget() -> None:
    _requested.clear()
    _previews.clear()
    for uid in list(_work):
        _cancel(uid)


def _cancel(uid: int) -> None:
    work = _work.pop(uid, None)
    if work is not None:
        work.job.cancel()


def _tick() -> float | None:
    for uid in list(_requested):
        _requested.discard(uid)
        obj = objects.find(uid)
        if obj is not None and obj.stormfield.morse.live and running.current() is None:
            _begin(obj)
    _collect_results()
    return TICK if _work or _requested else None


def _begin(obj: bpy.types.Object) -> None:
    _cancel(obj.session_uid)
    try:
        field = read_current(bpy.context, obj)
        surface, values = native_field(field.mesh, field.values)
        options = read_morse_settings(obj).options()
        if options["tau"]:
            options["tau"] = min(options["tau"], native.starting_tau(values, morse_state.UNITS[options["method"]]))
        job = native.start_morse(values, persistence=False, **options)
    except (ValueError, RuntimeError, OSError):
        _previews.pop(obj.session_uid, None)  # no field yet: the panel says why
        return
    _work[obj.session_uid] = _Work(job, surface, field.surface, field.lam)


def _collect_results() -> None:
    """Take over what is done."""
    global _count
    for uid, work in list(_work.items()):
        if not work.job.done:
            continue
        del _work[uid]
        try:
            found = work.job.result()
        except (ValueError, RuntimeError):
            continue  # the operator reports what is wrong; a preview is silent
        _count += 1
        graph = morse_graph(found, work.surface, work.lam)
        kinds = [entity.kind for entity in graph.entities]
        _previews[uid] = Preview(work.taken.of_triangles(np.asarray(found.face_sets)), kinds, work.lam, _count)
        redraw()
