# SPDX-License-Identifier: GPL-3.0-or-later
"""Notices that another object became active in the view, so that the list of elements can follow."""

import bpy

from ..scene.write import selection

_last: int | None = None  #: session uid of the object that was active


def follow(scene: bpy.types.Scene) -> None:
    """Called after each change of the scene; does something only when the active object is another than before."""
    global _last
    layer = bpy.context.view_layer
    active = layer.objects.active if layer is not None else None
    uid = active.session_uid if active is not None else None
    if uid == _last:
        return
    _last = uid
    if active is not None:
        selection.follow_view(active, scene)
