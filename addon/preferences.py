# SPDX-License-Identifier: GPL-3.0-or-later
"""Stormfield among Blender's preferences: whether this Blender can run it, seen where it is enabled."""

import sys

import bpy

from .operators import requirements


class STORMFIELD_Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, context: bpy.types.Context) -> None:
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
