# SPDX-License-Identifier: GPL-3.0-or-later
"""How the field is shown: the material and the viewport overlay."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .overridable import overridable

SHOWN_FIELDS = (
    ("sf_advection", "Advection", "The field that moves the texture"),
    ("sf_orientation", "Orientation", "The field that turns the texture"),
)
STYLES = (
    ("STROKES", "Strokes", "Short streamlines, thin behind and wide at the front"),
    ("ARROWS", "Arrows", "One arrow for each place"),
    ("NONE", "None", "No strokes or arrows"),
)


@overridable
class LookProperties(bpy.types.PropertyGroup):
    show_overlay: BoolProperty(name="Overlay", description="Show the field in the 3D view", default=True)
    shown_field: EnumProperty(name="Show", description="Which of the two fields is drawn", items=SHOWN_FIELDS)
    style: EnumProperty(name="Style", description="How directions are drawn", items=STYLES)
    spacing: FloatProperty(
        name="Distance",
        description="Distance between strokes or arrows in the view; zooming in shows more of them (pixels at 100 % "
        "interface scale)",
        min=6.0,
        soft_max=60.0,
        max=400.0,
        default=17.0,
    )
    length: FloatProperty(
        name="Length",
        description="Length of a stroke over the distance between strokes (ratio)",
        min=0.2,
        soft_max=6.0,
        max=20.0,
        default=2.2,
    )
    width: FloatProperty(
        name="Width",
        description="Width of a stroke, besides its dark rim (pixels at 100 % interface scale)",
        min=0.5,
        max=10.0,
        default=2.6,
    )
    opacity: FloatProperty(
        name="Opacity",
        description="Opacity of strokes and arrows (factor 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=1.0,
    )
    show_motion: BoolProperty(
        name="Moving Dashes",
        description="Let a bright dash run along each stroke while the animation plays or the pointer is over the view",
        default=True,
    )
    show_elements: BoolProperty(
        name="Elements",
        description="Draw the elements above the surface: paths with arrows of travel and ticks at every tenth of λ, "
        "rings for the radius with a sign for the turning, and where paths meet",
        default=True,
    )
    show_fixed_points: BoolProperty(
        name="Fixed Points", description="Mark sources, sinks, saddles and centers at the current λ", default=True
    )
    legend_folded: BoolProperty(
        name="Fold Legend", description="Show the first line of the legend only; click it in the view", default=False
    )
    show_legend: BoolProperty(
        name="Legend", description="Name the colours and count the fixed points in a corner of the view", default=True
    )
