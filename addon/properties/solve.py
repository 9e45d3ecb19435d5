# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the space-time solve."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..model.design import SolveSettings
from .overridable import overridable

DEFAULTS = SolveSettings()


@overridable
class SolveProperties(bpy.types.PropertyGroup):
    samples: IntProperty(
        name="Time Samples",
        description="Moments that are solved between the begin of the design and its end (count of λ samples): "
        "more show faster storms more exactly",
        min=2,
        soft_max=200,
        max=2000,
        default=DEFAULTS.samples,
    )
    lambda_weight: FloatProperty(
        name="Calmness",
        description="How strongly the field resists change in time against change over the surface (stiffness along λ, "
        "ratio, no unit): higher is calmer, lower follows the elements more closely",
        min=0.01,
        soft_max=100.0,
        max=10000.0,
        default=DEFAULTS.lambda_weight,
    )
    even_speed: FloatProperty(
        name="Even Speed",
        description="0 keeps the solved speed, which fades far from the elements; 1 makes the speed "
        "even everywhere with a smooth fall to fixed points (factor 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.8,
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="Relative residual at which the solver may stop (ratio, no unit). At any tolerance it continues "
        "until the field is within about half a percent of the exact one",
        min=1e-9,
        max=1e-1,
        default=DEFAULTS.tolerance,
        precision=6,
        step=0.01,
    )
    border: EnumProperty(
        name="Border",
        description="What the flow does at the border of an open surface",
        items=(
            ("open", "Open", "The flow crosses the border as it likes"),
            (
                "wall",
                "Wall",
                "The flow runs along the border and never crosses it; the solve takes about twice as long",
            ),
            ("inflow", "Inflow", "The flow comes in over all of the border; the solve takes about twice as long"),
        ),
    )
    solve_on: EnumProperty(
        name="Solve On",
        description="Where the field is worked out; it always lives on the vertices of the mesh",
        items=(
            ("MESH", "Mesh", "The mesh as it is"),
            ("DENSITY", "Density", "The mesh refined inside the solve; its own vertices take their vectors from there"),
        ),
    )
    edge: FloatProperty(
        name="Edge Length",
        description="The mesh is refined inside the solve until no edge is longer, in mesh units (object space)",
        min=1e-6,
        default=0.05,
        precision=3,
        step=1,
        subtype="DISTANCE",
    )
    weld: FloatProperty(
        name="Join Seams",
        description="Border vertices within this distance are solved as one, so that the field crosses seams and split "
        "faces (part of the object's size, no unit); 0 keeps them apart, as islands. The mesh itself stays as it is",
        min=0.0,
        max=0.1,
        soft_max=0.01,
        default=DEFAULTS.weld,
        precision=6,
        step=0.01,
    )
    keep_solver: BoolProperty(
        name="Start from Last Solve",
        description="Keep the solver's state between edits (some 40 bytes per vertex and λ sample): solving again "
        "starts from the last field and takes about half the time. A bake solves from zero first, so its files "
        "never depend on earlier edits",
        default=True,
    )
    solved: StringProperty(
        name="Solved", description="What the last solve read, to know when the field is out of date", options={"HIDDEN"}
    )
