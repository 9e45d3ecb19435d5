# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist has chosen for Stormfield in Blender's preferences; the defaults where it is not enabled there.

user_preferences.read().samples
"""

from dataclasses import dataclass, fields
from typing import Any

import bpy

from ...model.design import SolveSettings

#: Name under which the add-on is enabled: the package that holds scene/.
ADDON = __package__.rpartition(".scene")[0]


@dataclass(frozen=True)
class UserPreferences:
    palette: str = "COLOR_BLIND_SAFE"
    cache_folder: str = ""  #: of caches whose object names none; empty: beside the .blend file
    samples: int = SolveSettings().samples
    units: str = "MESH"


def read() -> UserPreferences:
    addon = bpy.context.preferences.addons.get(ADDON)
    if addon is None or addon.preferences is None:
        return UserPreferences()
    chosen: Any = addon.preferences
    return UserPreferences(**{item.name: getattr(chosen, item.name) for item in fields(UserPreferences)})


def length_text(context: bpy.types.Context, length: float, scale: float) -> str:
    """A length of mesh units as the scene shows lengths; empty where mesh units are shown. scale: of the object."""
    if read().units == "MESH":
        return ""
    units = context.scene.unit_settings
    if units.system == "NONE":
        return f"{length * scale:.3g}"
    return bpy.utils.units.to_string(units.system, "LENGTH", length * scale * units.scale_length, precision=3)
