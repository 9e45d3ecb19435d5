# SPDX-License-Identifier: GPL-3.0-or-later
"""The last Morse decomposition of each object, from which simplification and refinement start.

Known by the object's session uid, and never saved: after a file was opened, Morse Sets makes it again. The slider
*Simplify* takes effect a moment after it has stopped, so that dragging stays smooth.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import bpy
import numpy as np

from .. import native
from ..analysis.steps import MorseSets, native_field
from ..model.mesh_data import MeshData
from ..model.words import MorseMethod, MorseOptions
from ..scene.write import analysis_objects
from . import objects

#: What τ is of each method that has one, in the core's words.
UNITS: dict[MorseMethod, Literal["time", "length"]] = {"tau": "time", "spatial": "length"}
#: Seconds that a slider must stay the same before work begins.
PAUSE = 0.15


@dataclass
class MorseState:
    found: MorseSets
    attribute: str
    serial: int


_states: dict[int, MorseState] = {}
_serials = itertools.count(1)


def refine_options(settings, mesh: MeshData, values: np.ndarray) -> MorseOptions:
    """Options of native.start_morse for a refinement of that field as the panel says."""
    options: MorseOptions = {"method": settings.method, "refine": True, "max_seconds": settings.seconds}
    if settings.method == "geometry":
        return {**options, "eps": settings.eps / 100.0, "relative": True, "persistence": settings.persistence}
    begin = settings.length if settings.method == "spatial" else settings.tau
    if begin == 0.0:  # below the τ that a single map would take
        _, field = native_field(mesh, values)
        begin = 0.5 * native.starting_tau(field, UNITS[settings.method])
    return {**options, "tau": begin, "tau_max": begin * settings.tau_max}


def why_set_stays(obj: bpy.types.Object) -> str:
    """Why the selected set cannot be refined by itself, and the cure; empty when it can."""
    state, entities = of(obj), obj.stormfield.analysis.mcg
    if state is None:
        return "Find Regions with the method Directions, or Refine, first"
    if entities.selected() is None:
        return "Select a region in the list, the graph or the view first"
    decomposition = state.found.decomposition
    if decomposition.stop is None and (decomposition.method != "geometry" or decomposition.eps > 0):
        return "Regions of one flow time everywhere, or of Directions with an error, stay as they are; use Refine first"
    return ""


def why_no_simplification(obj: bpy.types.Object) -> str:
    """Why the shown sets cannot be simplified, and the cure; empty when they can."""
    state = of(obj)
    if state is None:
        return "Find Regions again to simplify or refine them"
    if state.found.decomposition.method != "geometry":
        return "Regions of a flow cannot be simplified; find or refine regions by Directions"
    return ""


def remember(obj: bpy.types.Object, found: MorseSets, attribute: str) -> None:
    state = MorseState(found, attribute, next(_serials))
    obj.stormfield.analysis.mcg.serial = state.serial
    _states[obj.session_uid] = state


def of(obj: bpy.types.Object) -> MorseState | None:
    """What the shown sets were made from; None where undo or another file has brought others back."""
    state = _states.get(obj.session_uid)
    return state if state is not None and state.serial == obj.stormfield.analysis.mcg.serial else None


def forget() -> None:
    _states.clear()


def simplify_later(obj: bpy.types.Object) -> None:
    """Called while the slider moves; simplifies once it has stopped."""
    uid = obj.session_uid
    if bpy.app.background:
        simplify(obj)
        return

    def work():
        found = objects.find(uid)
        if found is not None:
            simplify(found)
            bpy.ops.ed.undo_push(message="Simplify Regions")

    _after_pause("simplify", work)


def simplify(obj: bpy.types.Object) -> bool:
    """Merge what errors up to the slider's value merge; whether there was a decomposition to merge in."""
    state = of(obj)
    if state is None or why_no_simplification(obj):
        return False
    simpler = state.found.simplified(obj.stormfield.morse.simplify / 100.0)
    analysis_objects.show_morse(obj, simpler.graph, simpler.decomposition.face_sets, state.attribute)
    return True


_pending: dict[str, Callable[[], None]] = {}


def _after_pause(what: str, work: Callable[[], None]) -> None:
    """Run `work` after PAUSE without another call for the same thing."""
    earlier = _pending.pop(what, None)
    if earlier is not None and bpy.app.timers.is_registered(earlier):
        bpy.app.timers.unregister(earlier)
    _pending[what] = work
    bpy.app.timers.register(work, first_interval=PAUSE)
