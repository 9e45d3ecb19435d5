# SPDX-License-Identifier: GPL-3.0-or-later
"""The offer to show what a farm has baked since the file was saved."""

import bpy

from ..session import found_caches
from .panel_parts import text_lines


def draw_offer(context: bpy.types.Context, layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """What was found and the button that shows it; nothing where nothing was."""
    words = found_caches.offered(obj)
    if words:
        box = layout.box()
        text_lines(context, box, f"Baked for these settings, and not shown yet: {', '.join(words)}", icon="INFO")
        box.operator("stormfield.use_baked_caches", icon="IMPORT")
