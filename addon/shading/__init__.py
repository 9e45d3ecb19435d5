# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that flow: procedural, CC0, for Cycles and EEVEE, built as node trees from the baked attributes.

From an image: shading/from_image.py.
``MATERIALS`` maps an identifier to (label, builder); ``shared_material`` is the one of a file, ``build_material`` makes
a new one.
Settings of a builder are the inputs of its node group in lower case.
"""

from __future__ import annotations

import bpy

from .brushed_stripes import brushed_stripes
from .caustic_ripple import caustic_ripple
from .fibres import fibres
from .lava import lava
from .storm_clouds import storm_clouds

MATERIALS = {
    "storm_clouds": ("Storm Clouds", storm_clouds),
    "lava": ("Lava", lava),
    "brushed_stripes": ("Brushed Stripes", brushed_stripes),
    "caustic_ripple": ("Caustic Ripple", caustic_ripple),
    "fibres": ("Fibres", fibres),
}


#: Custom property of our materials: their identifier. Never a name: an artist may have a "Lava" of their own.
MARK = "stormfield"


def shared_material(identifier: str) -> bpy.types.Material:
    """The file's material of that identifier as the artist left it, built where there is none yet."""
    known = (material for material in bpy.data.materials if material.get(MARK) == identifier)
    return next(known, None) or build_material(identifier)


def build_material(identifier: str, **settings: float) -> bpy.types.Material:
    """A new material of that identifier."""
    if identifier not in MATERIALS:
        raise ValueError(f"There is no material '{identifier}'; choose one of {', '.join(MATERIALS)}")
    material = MATERIALS[identifier][1](**settings)
    material[MARK] = identifier
    return material
