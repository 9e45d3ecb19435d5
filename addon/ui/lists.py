"""The list of design elements."""

import bpy

from ..properties.element import TYPES

TYPE_ICONS = {key: icon for key, _label, _text, icon, _number in TYPES}


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
        else:
            times.label(text=f"{item.lam_start:.2g}–{item.lam_end:.2g}")
        row.prop(item, "enabled", text="", emboss=False, icon="HIDE_OFF" if item.enabled else "HIDE_ON")


CLASSES = (STORMFIELD_UL_elements,)
