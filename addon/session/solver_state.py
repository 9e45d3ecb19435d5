"""The solver of the field that is being edited, kept between two presses of Solve. Never saved.

One at a time: the memory of another object is given back first. Background mode and the command line keep none, so what
they solve never depends on what was solved before.
"""

import bpy

from ..solve import SolverState

_name = ""
_memory: SolverState | None = None


def of(obj: bpy.types.Object) -> SolverState | None:
    """The memory for solves of `obj`; None in background mode."""
    global _name, _memory
    if bpy.app.background:
        return None
    if _memory is None or _name != obj.name:
        forget()
        _name, _memory = obj.name, SolverState()
    return _memory


def forget() -> None:
    """Give the memory back; the next solve starts from zero."""
    global _memory
    _memory = None
