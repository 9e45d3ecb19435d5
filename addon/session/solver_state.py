# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last solve of the field that is being edited leaves for the next one. Never saved.

One at a time: that of another object is given back first. Background mode and the command line keep none, so what they
solve never depends on what was solved before.
"""

import bpy

from ..bake.reuse import Reuse
from ..solve import SolverState

_uid: int | None = None
_state: SolverState | None = None
_reused: tuple[int, Reuse] | None = None


def of(obj: bpy.types.Object) -> SolverState | None:
    """The state for solves of `obj`; None in background mode."""
    global _uid, _state
    if bpy.app.background:
        return None
    if _state is None or _uid != obj.session_uid:
        forget()
        _uid, _state = obj.session_uid, SolverState()
    return _state


def reuse_of(obj: bpy.types.Object) -> Reuse:
    """What the last solve left for one with other edits; in background mode too, since it changes no bits."""
    global _reused
    if _reused is None or _reused[0] != obj.session_uid:
        _reused = (obj.session_uid, Reuse())
    return _reused[1]


def forget() -> None:
    """Give the memory back; the next solve starts from zero."""
    global _state, _reused
    _state = _reused = None
