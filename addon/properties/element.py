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
    (
        "attachment",
        "Attachment Line",
        "The flow runs along the curve, or along the empty's X axis, and gathers on it from both sides (an attachment "
        "element)",
        "TRACKING_FORWARDS",
        4,
    ),
    (
        "separation",
        "Separation Line",
        "The flow runs along the curve, or along the empty's X axis, and parts from it to both sides (a separation "
        "element)",
        "TRACKING_BACKWARDS",
        5,
    ),
    (
        "orbit",
        "Orbit",
        "The flow goes round and round on the closed curve, which draws in or sends away what is beside it (a periodic "
        "orbit)",
        "CURVE_NCIRCLE",
        6,
    ),
    (
        "bifurcation",
        "Bifurcation",
        "At one moment of the design a pair of points appears or vanishes at the empty, or a storm turns from drawing "
        "in to sending away (a bifurcation)",
        "PARTICLE_DATA",
        7,
    ),
    (
        "brush",
        "Brush Stroke",
        "The flow beside the curve is combed after the rest is solved, in the order of the list; elsewhere it stays as "
        "it is",
        "BRUSH_DATA",
        8,
    ),
)
BRUSH_MODES = (
    ("replace", "Replace", "The flow takes direction and strength of the stroke", 0),
    ("add", "Add", "The stroke is added to the flow", 1),
    ("strength", "Strength", "The flow takes the strength of the stroke and keeps its direction", 2),
    ("smooth", "Smooth", "The flow becomes as smooth as what is around the stroke lets it be", 3),
)
BIFURCATION_KINDS = (
    ("appear_sink", "Drain Appears", "A drain and a crossing appear together and move apart along the X axis", 0),
    ("appear_source", "Spring Appears", "A spring and a crossing appear together and move apart along the X axis", 1),
    ("vanish_sink", "Drain Vanishes", "A drain and a crossing approach along the X axis and vanish together", 2),
    ("vanish_source", "Spring Vanishes", "A spring and a crossing approach along the X axis and vanish together", 3),
    ("hopf_birth", "Orbit Is Born", "A spiral that draws in begins to send away, and sheds an attracting orbit", 4),
    ("hopf_death", "Orbit Dies", "An attracting orbit shrinks onto the spiral inside it, which begins to draw in", 5),
)
ORBIT_KINDS = (
    ("attracting", "Attracting", "The flow on both sides spirals towards the curve", 0),
    ("repelling", "Repelling", "The flow on both sides spirals away from the curve", 1),
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
    orbit_kind: EnumProperty(name="Kind", description="What an orbit does with the flow beside it", items=ORBIT_KINDS)
    mode: EnumProperty(name="Mode", description="What a brush stroke does with the flow beside it", items=BRUSH_MODES)
    falloff: FloatProperty(
        name="Falloff",
        description="Part of the radius over which a brush stroke fades (factor 0..1): 0 has a hard edge, 1 fades from "
        "the middle on",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.5,
    )
    bifurcation_kind: EnumProperty(
        name="Kind", description="What happens at the moment of a bifurcation", items=BIFURCATION_KINDS
    )
    reach: FloatProperty(
        name="Reach",
        description="Time along the design (length of λ, 0..1) from the bifurcation until its points are a radius "
        "apart, or its orbit has half the radius",
        min=0.001,
        max=1.0,
        default=0.2,
        precision=3,
        step=1,
    )
    reverse: BoolProperty(
        name="Reverse",
        description="The flow goes round the orbit against the direction of its curve, or clockwise at a bifurcation",
        default=False,
    )
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
        description="Angle of a saddle's outgoing axis, or of a direction, from the empty's X axis, in degrees",
        subtype="ANGLE",
        min=-math.pi,
        max=math.pi,
        default=0.0,
    )
    pull: FloatProperty(
        name="Pull",
        description="How fast flow beside the line nears it or leaves it: its speed over its distance from the line, "
        "per second",
        min=0.0001,
        soft_min=0.1,
        soft_max=20.0,
        max=10000.0,
        default=4.0,
        precision=2,
        step=10,
    )
    fade_in: FloatProperty(
        name="Fade In",
        description="Time along the design (length of λ, 0..1) over which the strength grows from nothing after the "
        "element begins",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=3,
        step=1,
    )
    fade_out: FloatProperty(
        name="Fade Out",
        description="Time along the design (length of λ, 0..1) over which the strength falls to nothing before the "
        "element ends",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=3,
        step=1,
    )
    hard: BoolProperty(
        name="Exact",
        description="The inner third of the element is met exactly instead of in balance with its neighbours",
        default=False,
    )
