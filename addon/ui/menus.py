# SPDX-License-Identifier: GPL-3.0-or-later
"""Menus: what a selected curve means, places for storms, presets, and Add → Stormfield."""

import bpy

from ..operators.elements import PRESETS
from ..properties.element import BIFURCATION_KINDS, KINDS, TYPES
from . import pictures

#: Types that are drawn from the menu; the others have pictures in the panel.
DRAWN_HERE = ("attachment", "separation", "orbit", "brush")


class STORMFIELD_MT_add_selected(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_add_selected"
    bl_label = "Add from Selected"
    bl_description = "Make the selected curves and empties elements"

    def draw(self, _context):
        for key, label, _text, icon, _number in TYPES:
            self.layout.operator("stormfield.add_elements", text=label, icon=icon).type = key


class STORMFIELD_MT_place(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_place"
    bl_label = "Place at Cursor"
    bl_description = "Place a storm, spring, drain or bifurcation on the surface nearest to the 3D cursor"

    def draw(self, _context):
        for key, label, *_ in KINDS:
            self.layout.operator("stormfield.place_element", text=label).kind = key
        self.layout.separator()
        for key, label, *_ in BIFURCATION_KINDS:
            self.layout.operator("stormfield.place_bifurcation", text=label).kind = key


class STORMFIELD_MT_not_drawn(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_not_drawn"
    bl_label = "Other Elements"
    bl_description = (
        "Lines and orbits to draw, and elements of what is there: selected curves and empties, or the "
        "place of the 3D cursor"
    )

    def draw(self, _context):
        for key, label, _text, icon, _number in TYPES:
            if key in DRAWN_HERE:
                self.layout.operator("stormfield.draw_element", text=f"Draw {label}", icon=icon).type = key
        self.layout.separator()
        self.layout.menu("STORMFIELD_MT_add_selected", text="From Selected", icon="RESTRICT_SELECT_OFF")
        self.layout.menu("STORMFIELD_MT_place", text="At Cursor", icon="PIVOT_CURSOR")


class STORMFIELD_MT_element_list(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_element_list"
    bl_label = "Elements"
    bl_description = "Move the active element in the list, or give it the settings of a preset"

    def draw(self, _context):
        layout = self.layout
        layout.operator("stormfield.move_element", text="Move Up", icon="TRIA_UP").direction = "UP"
        layout.operator("stormfield.move_element", text="Move Down", icon="TRIA_DOWN").direction = "DOWN"
        layout.separator()
        for key, label in ((key, preset[0]) for key, preset in PRESETS.items() if key != "MERGE"):
            layout.operator("stormfield.element_preset", text=f"Make {label}", icon_value=pictures.of(key)).preset = key


class STORMFIELD_MT_add(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_add"
    bl_label = "Stormfield"
    bl_description = "Whole scenes with a field, ready to solve"

    def draw(self, _context):
        self.layout.operator("stormfield.storm_merge", icon="FORCE_VORTEX")


def draw_add_menu(self, _context):
    self.layout.separator()
    self.layout.menu("STORMFIELD_MT_add", icon="FORCE_VORTEX")


def draw_import_menu(self, _context):
    text = "Stormfield Data (.nc, .vtp, .vtu, .pvd, .ply, .t, λ cache)"
    self.layout.operator("stormfield.import_data", text=text)


CLASSES = (
    STORMFIELD_MT_add_selected,
    STORMFIELD_MT_place,
    STORMFIELD_MT_not_drawn,
    STORMFIELD_MT_element_list,
    STORMFIELD_MT_add,
)
