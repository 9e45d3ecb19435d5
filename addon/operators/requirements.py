# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether this Blender has what Stormfield needs, checked once: the panel names the reason and the cure."""

from functools import cache

import bpy

from .. import native


@cache
def problem() -> str:
    """Empty when all is well, otherwise the reason and the cure in one sentence."""
    if not _has_usd():
        return (
            "This Blender was built without USD, which brings the field onto the mesh: use the Blender of blender.org"
        )
    try:
        native.check()
    except ImportError as fault:
        return str(fault)
    return ""


def _has_usd() -> bool:
    return bool(bpy.app.build_options.usd)
