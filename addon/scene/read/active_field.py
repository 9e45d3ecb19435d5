# SPDX-License-Identifier: GPL-3.0-or-later
"""Which field the artist works on."""

import bpy


def active_field(context: bpy.types.Context) -> bpy.types.Object | None:
    """The object whose field the artist works on: the active one, else the one whose element is active, else the only
    one."""
    active = context.object
    if active is not None and active.stormfield.enabled:
        return active
    fields = [obj for obj in context.scene.objects if obj.type == "MESH" and obj.stormfield.enabled]
    for obj in fields:
        if active is not None and any(element.source == active for element in obj.stormfield.elements):
            return obj
    return fields[0] if len(fields) == 1 else None
