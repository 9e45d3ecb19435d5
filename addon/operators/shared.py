# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: conditions of the context, reports, redrawing."""

import bpy

from ..scene.read.active_field import active_field


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
