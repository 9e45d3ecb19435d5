# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of the flow on a surface of any colour: pale, and a little bright by themselves, so that they show in the
shade of dark surfaces too. The viewport's Solid mode shows the same pale colour.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..scene.nodes.tree import new_material, srgb

NAME = "Flow Lines"
PALE = "#f2ead8"


def flow_lines() -> bpy.types.Material:
    """The material of that name in the file, as the artist left it; made when it is missing."""
    if (found := bpy.data.materials.get(NAME)) is not None:
        return found
    material, tree = new_material(NAME)
    pale: Any = srgb(PALE)
    material.diffuse_color = pale
    tree.surface(tree.principled(base_color=pale, roughness=0.6, emission_color=pale, emission_strength=0.25))
    return material
