# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that flow: procedural, CC0, for Cycles and EEVEE, built as node trees from the baked attributes.

``MATERIALS`` maps an identifier to (label, builder); ``build_material`` makes one and returns it.
Settings of a builder are the inputs of its node group in lower case.
"""

from __future__ import annotations

import bpy

from .brushed_stripes import brushed_stripes
from .caustic_ripple import caustic_ripple
from .lava import lava
from .storm_clouds import storm_clouds

MATERIALS = {
    "storm_clouds": ("Storm Clouds", storm_clouds),
    "lava": ("Lava", lava),
    "brushed_stripes": ("Brushed Stripes", brushed_stripes),
    "caustic_ripple": ("Caustic Ripple", caustic_ripple),
}


def build_material(identifier: str, **settings: float) -> bpy.types.Material:
    """The material of that identifier; one of the same name is rebuilt, so that its users follow."""
    if identifier not in MATERIALS:
        raise ValueError(f"There is no material '{identifier}'; choose one of {', '.join(MATERIALS)}")
    return MATERIALS[identifier][1](**settings)
