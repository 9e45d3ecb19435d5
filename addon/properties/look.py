# SPDX-License-Identifier: GPL-3.0-or-later
"""How the field is shown: the material and the viewport overlay."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

SHOWN_FIELDS = (
    ("sf_advection", "Advection", "The field that moves the texture"),
    ("sf_orientation", "Orientation", "The field that turns the texture"),
)
STYLES = (
    ("STROKES", "Strokes", "Short streamlines, bright at the front and fading behind"),
    ("ARROWS", "Arrows", "One arrow for each place"),
    ("NONE", "None", "No strokes or arrows"),
)


class LookProperties(bpy.types.PropertyGroup):
    show_overlay: BoolProperty(name="Overlay", description="Show the field in the 3D view", default=True)
    shown_field: EnumProperty(name="Show", description="Which of the two fields is drawn", items=SHOWN_FIELDS)
    style: EnumProperty(name="Style", description="How directions are drawn", items=STYLES)
    density: IntProperty(
        name="Density",
        description="Strokes or arrows along the longest side of the object (count)",
        min=4,
        soft_max=80,
        max=200,
        default=40,
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
        name="Width", description="Width of a stroke (pixels at 100 % interface scale)", min=0.5, max=10.0, default=2.0
    )
    opacity: FloatProperty(
        name="Opacity",
        description="Opacity of strokes and arrows (factor 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.85,
    )
    show_fixed_points: BoolProperty(
        name="Fixed Points", description="Mark sources, sinks, saddles and centers at the current λ", default=True
    )
    show_legend: BoolProperty(
        name="Legend", description="Name the colours and count the fixed points in a corner of the view", default=True
    )
