# SPDX-License-Identifier: GPL-3.0-or-later
"""What an edit would do, found out beside the work: partners of the selected entity, what Simplify would leave.

The overlay asks at every redraw; what is asked for last wins, and what is known is kept while analysis and selection
stay. The core works on its own threads, watched by a timer. Never saved. Background mode waits.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy

from ..edits.partners import Partner, Simpler, partner_steps, simplify_steps
from ..model.edits import EntityAt
from ..scene.read.current_field import is_given, why_no_field
from ..scene.read.mesh import read_mesh
from ..scene.read.sample import Sample
from ..scene.write.selection import redraw
from ..work import Steps
from . import objects, running

#: Seconds between two looks at the work, in one look, and that a selection stays before work begins.
TICK, SLICE, PAUSE = 0.05, 0.02, 0.15
#: λ that differ by less are the same.
SAME_LAMBDA = 5e-4


@dataclass
class _Work:
    """What was asked for one object: by `key`, as far as it is known."""

    key: tuple
    make: Callable[[bpy.types.Object], Steps]
    steps: Steps | None = None
    done: bool = False
    partners: dict[int, Partner] = field(default_factory=dict)
    simpler: Simpler | None = None


_works: dict[tuple[int, str], _Work] = {}


def partners(obj: bpy.types.Object) -> dict[int, Partner]:
    """With what the selected entity of the graph can be cancelled, by places in the list; what is known by now."""
    ecg = obj.stormfield.analysis.ecg
    if not _can_be_edited(obj) or ecg.selected() is None or not obj.stormfield.analysis.show_partners:
        _drop(obj, "partners")
        return {}
    key = (obj.stormfield.analysis.version, ecg.active, len(ecg.items))
    return _asked(obj, "partners", key, _partner_steps).partners


def simpler(obj: bpy.types.Object) -> Simpler | None:
    """What the chosen number of Simplify would leave; None while it is being found out, and where it is not shown."""
    analysis = obj.stormfield.analysis
    if not _can_be_edited(obj) or not analysis.preview_simplify or analysis.keep >= len(analysis.ecg.items):
        _drop(obj, "simpler")
        return None
    key = (analysis.version, analysis.keep, len(analysis.ecg.items))
    return _asked(obj, "simpler", key, _simplify_steps).simpler


def is_busy(obj: bpy.types.Object) -> bool:
    """Whether what Simplify would leave is being found out."""
    work = _works.get((obj.session_uid, "simpler"))
    return work is not None and not work.done


def forget() -> None:
    for uid, which in list(_works):
        _end(_works.pop((uid, which)))


def _can_be_edited(obj: bpy.types.Object) -> bool:
    """Cheap enough for every redraw: a graph of what is shown."""
    shown, ecg = obj.stormfield, obj.stormfield.analysis.ecg
    current = abs(shown.lam - ecg.lam) < SAME_LAMBDA and shown.look.shown_field == ecg.shown_field
    known = shown.solve.solved or is_given(obj)
    return bool(ecg.made and current and known and not why_no_field(obj))


def _asked(obj: bpy.types.Object, which: str, key: tuple, make: Callable[[bpy.types.Object], Steps]) -> _Work:
    name = (obj.session_uid, which)
    work = _works.get(name)
    if work is None or work.key != key:
        _drop(obj, which)
        work = _works[name] = _Work(key, make)
        if bpy.app.background:
            while not work.done:
                _advance(obj, work)
        elif not bpy.app.timers.is_registered(_tick):
            bpy.app.timers.register(_tick, first_interval=PAUSE)
    return work


def _drop(obj: bpy.types.Object, which: str) -> None:
    work = _works.pop((obj.session_uid, which), None)
    if work is not None:
        _end(work)


def _end(work: _Work) -> None:
    if work.steps is not None:
        work.steps.close()


def _tick() -> float | None:
    for name, work in list(_works.items()):
        obj = objects.find(name[0])
        if obj is None:
            _end(_works.pop(name))
        elif not work.done and running.current() is None:
            _advance(obj, work)
            redraw()
    return TICK if any(not work.done for work in _works.values()) else None


def _advance(obj: bpy.types.Object, work: _Work) -> None:
    """A slice of the work. A preview is silent: the operator says what is wrong."""
    until = time.monotonic() + SLICE
    try:
        if work.steps is None:
            work.steps = work.make(obj)
        while time.monotonic() < until:
            if next(work.steps).waiting:
                break
    except StopIteration as end:
        work.done, work.simpler = True, end.value
    except (ValueError, RuntimeError, OSError):
        work.done = True


def _entities(obj: bpy.types.Object) -> list[EntityAt]:
    return [EntityAt(item.kind, tuple(item.position)) for item in obj.stormfield.analysis.ecg.items]


def _sample(obj: bpy.types.Object) -> Sample:
    ecg = obj.stormfield.analysis.ecg
    return Sample(obj, read_mesh(obj), ecg.lam, ecg.shown_field)


def _partner_steps(obj: bpy.types.Object) -> Steps:
    found = _works[obj.session_uid, "partners"].partners
    entities, chosen = _entities(obj), obj.stormfield.analysis.ecg.active
    given = yield from _sample(obj).field()
    yield from partner_steps(given, entities, chosen, found)


def _simplify_steps(obj: bpy.types.Object) -> Steps:
    entities, keep = _entities(obj), obj.stormfield.analysis.keep
    given = yield from _sample(obj).field()
    return (yield from simplify_steps(given, entities, keep))
