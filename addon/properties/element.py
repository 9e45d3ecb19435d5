# SPDX-License-Identifier: GPL-3.0-or-later
"""One design element of a field: where it is comes from a curve or an empty, what it means from here."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, PointerProperty, StringProperty

from .overridable import overridable

TYPES = (
    (
        "singular",
        "Storm",
        "The flow turns around, leaves or meets a point: at an empty, or moving along a curve as time along the design "
        "passes (a singular element: a fixed point of the field)",
        "FORCE_VORTEX",
        0,
    ),
    ("streamline", "Stream", "The flow follows the curve from its start to its end (a streamline)", "CURVE_PATH", 1),
    (
        "pathline",
        "Particle Path",
        "A particle travels along the curve as time along the design passes from start to end (a pathline)",
        "TRACKING",
        2,
    ),
    (
        "regular",
        "Wind Direction",
        "The flow has one direction here: the empty's X axis, or from curve start to curve end (a regular element)",
        "FORWARD",
        3,
    ),
)
KINDS = (
    ("vortex_ccw", "Vortex, Left", "Turns left (counter-clockwise) around the point, seen from outside", 0),
    ("vortex_cw", "Vortex, Right", "Turns right (clockwise) around the point, seen from outside", 1),
    ("spiral_in_ccw", "Spiral In, Left", "Turns left and flows in: a cyclone of the north", 2),
    ("spiral_in_cw", "Spiral In, Right", "Turns right and flows in: a cyclone of the south", 3),
    ("spiral_out_ccw", "Spiral Out, Left", "Turns left and flows out", 4),
    ("spiral_out_cw", "Spiral Out, Right", "Turns right and flows out", 5),
    ("source", "Source", "Everything flows away from the point", 6),
    ("sink", "Sink", "Everything flows to the point", 7),
    ("saddle", "Saddle", "Flows in along one axis and out along the other", 8),
)
FIELDS = (
    ("both", "Both", "Shapes the orientation field and the advection field"),
    ("orientation", "Orientation", "Shapes only the field that turns the texture"),
    ("advection", "Advection", "Shapes only the field that moves the texture"),
)
SOURCES = {"CURVE", "CURVES", "EMPTY", "FONT", "GREASEPENCIL", "MESH"}


def _is_source(_self, candidate: bpy.types.Object) -> bool:
    return candidate.type in SOURCES


@overridable
class ElementProperties(bpy.types.PropertyGroup):
    name: StringProperty(name="Name", description="Name of the element, used in messages", default="Element")
    enabled: BoolProperty(name="Enabled", description="The element takes part in the next solve", default=True)
    source: PointerProperty(
        type=bpy.types.Object,
        name="Source",
        poll=_is_source,
        description="Curve, text, hair curves, Grease Pencil, edges of a mesh, or empty where the element is; "
        "it may be animated, and hidden",
    )
    type: EnumProperty(name="Type", description="What the source object means for the field", items=TYPES)
    kind: EnumProperty(name="Kind", description="How the flow moves around the point", items=KINDS)
    field: EnumProperty(name="Field", description="Which of the two fields the element shapes", items=FIELDS)
    from_animation: BoolProperty(
        name="From Animation",
        default=False,
        description="Time follows the keyframes: the source's place at each frame counts at that frame's λ",
    )
    lam_start: FloatProperty(
        name="Starts at",
        description="Time along the design (λ, 0..1) at which the element begins",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=3,
        step=1,
    )
    lam_end: FloatProperty(
        name="Ends at",
        description="Time along the design (λ, 0..1) at which the element ends",
        min=0.0,
        max=1.0,
        default=1.0,
        precision=3,
        step=1,
    )
    strength: FloatProperty(
        name="Strength",
        description="Speed of the field at the element, in object sizes per second; "
        "the size of an object is the square root of its area",
        soft_min=0.01,
        min=0.0001,
        soft_max=2.0,
        max=1000.0,
        default=0.2,
        precision=3,
        step=1,
    )
    radius: FloatProperty(
        name="Radius",
        description="Distance to which the element holds the field, in mesh units (object space)",
        min=1e-5,
        soft_min=0.01,
        soft_max=2.0,
        default=0.2,
        precision=3,
        step=1,
    )
    angle: FloatProperty(
        name="Angle",
        description="Angle of a saddle's outgoing axis from the empty's X axis, in degrees",
        subtype="ANGLE",
        min=-math.pi,
        max=math.pi,
        default=0.0,
    )
    hard: BoolProperty(
        name="Exact",
        description="The inner third of the element is met exactly instead of in balance with its neighbours",
        default=False,
    )
