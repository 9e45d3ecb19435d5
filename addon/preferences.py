# SPDX-License-Identifier: GPL-3.0-or-later
"""Stormfield among Blender's preferences: whether this Blender can run it, and what holds for all files."""

import sys

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from .operators import requirements
from .scene.read.user_preferences import UserPreferences

DEFAULTS = UserPreferences()
PALETTES = (
    (
        "COLOR_BLIND_SAFE",
        "Safe for All Eyes",
        "Colours that stay apart for colour-blind eyes too; kinds differ in shape as well",
    ),
    ("CLASSIC", "Classic", "Sources green, sinks red, saddles blue, as in the literature"),
)
UNITS = (
    ("MESH", "Mesh Units", "Lengths as the mesh has them, before the object is scaled"),
    ("SCENE", "Scene Units", "Beside mesh units, lengths in the units of the scene, after the object is scaled"),
)


def _colours_changed(_self, context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()


class STORMFIELD_Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    palette: EnumProperty(
        name="Colours",
        description="Colours of sources, sinks, saddles and orbits in view, lists and graphs",
        items=PALETTES,
        default=DEFAULTS.palette,
        update=_colours_changed,
    )
    cache_folder: StringProperty(
        name="Cache Folder",
        description="Folder of the caches of objects that name none themselves; empty means stormfield_cache beside "
        "the .blend file, or Blender's temporary folder until the file is saved",
        subtype="DIR_PATH",
        default=DEFAULTS.cache_folder,
    )
    samples: IntProperty(
        name="Time Samples",
        description="Moments that a new field is solved at between begin and end of the design (count of λ samples)",
        min=2,
        soft_max=200,
        max=2000,
        default=DEFAULTS.samples,
    )
    units: EnumProperty(name="Lengths", description="How panels show lengths", items=UNITS, default=DEFAULTS.units)

    def draw(self, context: bpy.types.Context) -> None:
        self._draw_readiness()
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("palette", "cache_folder", "samples", "units"):
            layout.prop(self, name)

    def _draw_readiness(self) -> None:
        problem = requirements.problem()
        if not problem:
            self.layout.label(text="Ready: the compiled core fits this Blender.", icon="CHECKMARK")
            return
        box = self.layout.box()
        box.alert = True
        for number, line in enumerate(problem.split(": ")):
            box.label(text=line, icon="ERROR" if number == 0 else "BLANK1")


def register() -> None:
    bpy.utils.register_class(STORMFIELD_Preferences)
    if problem := requirements.problem():
        print(f"Stormfield: {problem}", file=sys.stderr)


def unregister() -> None:
    bpy.utils.unregister_class(STORMFIELD_Preferences)
