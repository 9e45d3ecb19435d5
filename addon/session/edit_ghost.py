# SPDX-License-Identifier: GPL-3.0-or-later
"""What an edit that is being tried would change, for the 3D view: a block of faces, and where a point would stand.

Never saved: previews set it, the overlay draws it.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ..scene.write.selection import redraw


@dataclass(frozen=True, eq=False)
class Ghost:
    faces: np.ndarray | None = None  #: (k,) triangles of the surface in the object's mesh
    place: np.ndarray | None = None  #: (3,) in object space
    kind: str = ""  #: of the point that would stand there
    allowed: bool | None = None  #: None while that is being found out
    text: str = ""  #: what must remain, or why it is refused


_ghosts: dict[int, Ghost] = {}


def of(obj: bpy.types.Object) -> Ghost | None:
    return _ghosts.get(obj.session_uid)


def show(obj: bpy.types.Object, ghost: Ghost | None) -> None:
    """None takes it away."""
    if ghost is None:
        _ghosts.pop(obj.session_uid, None)
    else:
        _ghosts[obj.session_uid] = ghost
    redraw()


def forget() -> None:
    _ghosts.clear()
