"""Which field the artist means."""

import bpy


def active_field(context: bpy.types.Context) -> bpy.types.Object | None:
    """The object whose field is meant: the active one, the one whose element the active object is, or the only one."""
    active = context.object
    if active is not None and active.stormfield.enabled:
        return active
    fields = [obj for obj in context.scene.objects if obj.type == "MESH" and obj.stormfield.enabled]
    for obj in fields:
        if active is not None and any(element.source == active for element in obj.stormfield.elements):
            return obj
    return fields[0] if len(fields) == 1 else None
