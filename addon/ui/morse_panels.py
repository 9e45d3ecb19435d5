# SPDX-License-Identifier: GPL-3.0-or-later
"""The Flow Regions panel: how Morse sets are found, refined and simplified."""

import bpy

from ..operators.morse import STORMFIELD_OT_morse_sets
from ..scene.read.active_field import active_field
from ..session import morse_state
from . import drawing_cache
from .panel_parts import FieldPanel, hint, job_button, text_lines


class STORMFIELD_PT_morse(FieldPanel, bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_morse"
    bl_parent_id = "STORMFIELD_PT_analysis"
    bl_label = "Flow Regions"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.settings_layout()
        obj = active_field(context)
        settings = obj.stormfield.morse

        def live(row):
            row.use_property_split = False
            row.prop(settings, "live", text="", icon="HIDE_OFF" if settings.live else "HIDE_ON")

        job_button(context, layout, STORMFIELD_OT_morse_sets, obj, "MOD_MASK", on_right=live, titles=("Refining",))
        column = layout.column()
        column.prop(settings, "method")
        if settings.method == "geometry":
            column.prop(settings, "eps")
            self._draw_simplify(context, layout, obj, settings)
        else:
            name = "tau" if settings.method == "tau" else "length"
            column.prop(settings, name)
            if getattr(settings, name) == 0:
                text_lines(context, layout, self._suggestion(obj, settings.method), icon="INFO")
        self._draw_refinement(context, layout, obj, settings)

    @staticmethod
    def _draw_simplify(context, layout, obj, settings):
        if not obj.stormfield.analysis.mcg.made:
            return
        reason = morse_state.why_no_simplification(obj)
        column = layout.column()
        column.enabled = not reason
        column.prop(settings, "simplify", slider=True)
        hint(context, layout, reason)

    @staticmethod
    def _draw_refinement(context, layout, obj, settings):
        header, body = layout.panel("stormfield_refinement", default_closed=False)
        header.label(text="Refinement")
        if body is None:
            return
        row = body.row(align=True)
        row.operator("stormfield.refine_morse", icon="MOD_MULTIRES")
        row.operator("stormfield.refine_set", text="This Region", icon="RESTRICT_SELECT_OFF")
        if obj.stormfield.analysis.mcg.made:
            hint(context, body, morse_state.why_set_stays(obj))
        column = body.column()
        if settings.method == "geometry":
            column.prop(settings, "persistence")
        else:
            column.prop(settings, "tau_max")
        column.prop(settings, "seconds")

    @staticmethod
    def _suggestion(obj, method: str) -> str:
        """What 0 stands for, where it is known."""
        found = drawing_cache.starting_tau(obj, method)
        if found is None:
            return "0 stands for a value found from mesh and field"
        return f"0 stands for {found:.3g} " + ("s" if method == "tau" else "mesh units")


CLASSES = (STORMFIELD_PT_morse,)
