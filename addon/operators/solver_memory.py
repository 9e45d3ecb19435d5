"""The solver of the field that is being edited, kept between two presses of Solve. Never saved.

One at a time: the memory of another object is given back first. Background mode and the command line keep none, so what
they solve never depends on what was solved before.
"""

import bpy

from ..solve import SolverMemory

_name = ""
_memory: SolverMemory | None = None


def of(obj: bpy.types.Object) -> SolverMemory | None:
    """The memory for solves of `obj`; None in background mode."""
    global _name, _memory
    if bpy.app.background:
        return None
    if _memory is None or _name != obj.name:
        forget()
        _name, _memory = obj.name, SolverMemory()
    return _memory


def forget() -> None:
    """Give the memory back; the next solve starts from zero."""
    global _memory
    _memory = None
