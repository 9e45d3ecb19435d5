"""What every operator asks of the context: which field is meant, and whether it may be changed now."""

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


class FieldOperator:
    """Mix-in of operators that need a field."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if active_field(context) is None:
            cls.poll_message_set("Select a mesh with a Stormfield field, or add one in the Field panel")
            return False
        return True


class ElementOperator(FieldOperator):
    """Mix-in of operators that need an active element."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if active_field(context).stormfield.active() is None:
            cls.poll_message_set("Choose an element in the list first")
            return False
        return True


def report_fault(operator: bpy.types.Operator, fault: Exception) -> set[str]:
    """A fault in plain words: what is wrong and the cure."""
    memory = "Not enough memory; use fewer λ samples or a coarser mesh"
    operator.report({"ERROR"}, memory if isinstance(fault, MemoryError) else str(fault))
    return {"CANCELLED"}


def redraw_sidebars(context: bpy.types.Context) -> None:
    """Draw the panels again, and nothing else: they do not follow module state by themselves."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if area.type == "VIEW_3D" and region.type == "UI":
                    region.tag_redraw()
