# SPDX-License-Identifier: GPL-3.0-or-later
"""The sign that the field is not what a solve would give now: in the Solve panel and at the top of the view."""

import bpy

from ..session import freshness
from .panel_parts import text_lines


def draw_in_panel(context: bpy.types.Context, layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """Why Solve is due, below its button; nothing while the field is up to date."""
    reason = freshness.why_out_of_date(obj)
    if reason:
        text_lines(context, layout, f"Out of date: {reason}", icon="FILE_REFRESH")


def sentence(obj: bpy.types.Object) -> str:
    """For the view: short, with the first reason and how many there are besides."""
    reasons = freshness.why_out_of_date(obj).split("; ")
    if not reasons[0]:
        return ""
    more = f" and {len(reasons) - 1} more" if len(reasons) > 1 else ""
    return f"Out of date: {reasons[0]}{more}. Solve again"
