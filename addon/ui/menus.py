# SPDX-License-Identifier: GPL-3.0-or-later
"""Menus: what a drawn or selected curve means, places for fixed points, presets, and Add → Stormfield."""

import bpy

from ..operators.elements import PRESETS
from ..properties.element import KINDS, TYPES


class STORMFIELD_MT_draw(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_draw"
    bl_label = "Draw on Surface"
    bl_description = "Draw curves on the surface with Blender's own Draw tool"

    def draw(self, _context):
        for key, label, _text, icon, _number in TYPES:
            name = "Singularity Path" if key == "singular" else label
            self.layout.operator("stormfield.draw_element", text=name, icon=icon).type = key


class STORMFIELD_MT_add_selected(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_add_selected"
    bl_label = "Add from Selected"
    bl_description = "Make the selected curves and empties elements"

    def draw(self, _context):
        for key, label, _text, icon, _number in TYPES:
            name = "Singular (path or point)" if key == "singular" else label
            self.layout.operator("stormfield.add_elements", text=name, icon=icon).type = key


class STORMFIELD_MT_place(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_place"
    bl_label = "Place at Cursor"
    bl_description = "Place a fixed point on the surface nearest to the 3D cursor"

    def draw(self, _context):
        for key, label, *_ in KINDS:
            self.layout.operator("stormfield.place_element", text=label).kind = key


class STORMFIELD_MT_element_presets(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_element_presets"
    bl_label = "Element Presets"
    bl_description = "Settings of the active element in one click"

    def draw(self, _context):
        for key, (label, _text, _settings) in PRESETS.items():
            self.layout.operator("stormfield.element_preset", text=label).preset = key


class STORMFIELD_MT_add(bpy.types.Menu):
    bl_idname = "STORMFIELD_MT_add"
    bl_label = "Stormfield"
    bl_description = "Whole scenes with a field, ready to solve"

    def draw(self, _context):
        self.layout.operator("stormfield.storm_merge", icon="FORCE_VORTEX")


def draw_add_menu(self, _context):
    self.layout.separator()
    self.layout.menu("STORMFIELD_MT_add", icon="FORCE_VORTEX")


CLASSES = (
    STORMFIELD_MT_draw,
    STORMFIELD_MT_add_selected,
    STORMFIELD_MT_place,
    STORMFIELD_MT_element_presets,
    STORMFIELD_MT_add,
)
