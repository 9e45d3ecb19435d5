# SPDX-License-Identifier: GPL-3.0-or-later
"""The lists of design elements and of what an analysis found."""

import bpy

from ..model.element_types import RULES
from ..properties.element import TYPES
from ..session import edit_preview
from . import icons

TYPE_ICONS = {key: icon for key, _label, _text, icon, _number in TYPES}

EDIT_ICONS = {
    "cancel": "TRASH",
    "simplify": "MOD_DECIM",
    "move": "EMPTY_ARROWS",
    "smooth": "MOD_SMOOTH",
    "transform": "ORIENTATION_GIMBAL",
}


class STORMFIELD_UL_elements(bpy.types.UIList):
    bl_idname = "STORMFIELD_UL_elements"

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property, _index=0, _flag=0):
        row = layout.row(align=True)
        row.active = item.enabled
        split = row.split(factor=0.68)
        split.prop(item, "name", text="", emboss=False, icon=TYPE_ICONS[item.type])
        times = split.row()
        times.alignment = "RIGHT"
        if item.source is None:
            times.alert = True
            times.label(text="no source", icon="ERROR")
        elif item.from_animation:
            times.label(text="keys")
        elif RULES[item.type].instant:
            times.label(text=f"{item.lam_start:.2g}")
        else:
            times.label(text=f"{item.lam_start:.2g}–{item.lam_end:.2g}")
        row.prop(item, "enabled", text="", emboss=False, icon="HIDE_OFF" if item.enabled else "HIDE_ON")


class STORMFIELD_UL_edits(bpy.types.UIList):
    bl_idname = "STORMFIELD_UL_edits"

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property, _index=0, _flag=0):
        row = layout.row(align=True)
        row.active = item.enabled
        split = row.split(factor=0.68)
        split.prop(item, "name", text="", emboss=False, icon=EDIT_ICONS[item.type])
        state = split.row()
        state.alignment = "RIGHT"
        state.alert = item.enabled and item.status == "refused"
        state.label(text=(item.status or "waiting") if item.enabled else "off")
        row.prop(item, "enabled", text="", emboss=False, icon="HIDE_OFF" if item.enabled else "HIDE_ON")


class STORMFIELD_UL_entities(bpy.types.UIList):
    bl_idname = "STORMFIELD_UL_entities"

    def draw_item(self, _context, layout, data, item, _icon, _active, _property, _index=0, _flag=0):
        lives = self.list_id == "history" and item.lam_end > item.lam_start  # two numbers
        split = layout.split(factor=0.58 if lives else 0.66)
        if self.list_id == "ecg":
            partner = edit_preview.partners(item.id_data).get(_index)
            split.active = partner is None or not partner.reason
        split.label(text=item.name, icon_value=icons.of(item.kind))
        number = split.row()
        number.alignment = "RIGHT"
        if item.faces:
            number.label(text=f"{item.faces} f")
        elif self.list_id != "history":
            number.label(text=f"{item.strength:.2g}" if item.strength else "")
        elif item.lam_end > item.lam_start:
            number.label(text=f"{item.lam_start:.2f}–{item.lam_end:.2f}")
        else:
            number.label(text=f"{item.lam:.2f}")

    def draw_filter(self, _context, layout):
        row = layout.row(align=True)
        row.prop(self, "filter_name", text="", icon="VIEWZOOM")
        row.prop(self, "use_filter_invert", text="", icon="ARROW_LEFTRIGHT")
        row.prop(self, "use_filter_sort_reverse", text="Weakest First", toggle=True)

    def filter_items(self, _context, data, _property):
        """By the filters of the list, then by name as in every list of Blender; the strongest first on request."""
        items = data.items
        name = self.filter_name.lower()
        shown = [data.passes(item) and (name in item.name.lower()) != self.use_filter_invert for item in items]
        if not name:
            shown = [data.passes(item) for item in items]
        order = []
        if self.use_filter_sort_reverse:
            ranked = sorted(range(len(items)), key=lambda i: items[i].strength)
            order = [0] * len(items)
            for place, index in enumerate(ranked):
                order[index] = place
        return [self.bitflag_filter_item if keep else 0 for keep in shown], order


CLASSES = (STORMFIELD_UL_elements, STORMFIELD_UL_edits, STORMFIELD_UL_entities)
