# SPDX-License-Identifier: GPL-3.0-or-later
"""Evenly Spaced Streamlines: the current field as a Curves object, ready for hair and curve shading."""

import bpy
from bpy.props import BoolProperty, FloatProperty

from ..analysis.streamlines import Settings, streamline_steps
from ..scene.read.current_field import read_current
from ..scene.write.curve_objects import make_curves
from ..shading.flow_lines import flow_lines
from .analyze import AnalysisOperator

#: Role of the Curves object under the field's mesh.
ROLE = "Streamlines"


class STORMFIELD_OT_streamlines(AnalysisOperator, bpy.types.Operator):
    """Draw the field at the current λ as evenly spaced curves, orbits and separatrices first. Run again to update"""

    bl_idname = "stormfield.streamlines"
    bl_label = "Evenly Spaced Streamlines"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Drawing streamlines on"

    density: FloatProperty(
        name="Distance",
        description="Distance between lines over the object's size, the square root of its area (fraction)",
        default=0.02,
        min=0.001,
        soft_min=0.005,
        soft_max=0.1,
        max=0.5,
        step=0.1,
        precision=3,
    )
    width: FloatProperty(
        name="Width",
        description="Width of a line over the distance between lines (fraction)",
        default=0.25,
        min=0.01,
        max=1.0,
    )
    taper: FloatProperty(
        name="Taper",
        description="How much lines narrow at their ends and next to other lines (factor 0..1)",
        subtype="FACTOR",
        default=1.0,
        min=0.0,
        max=1.0,
    )
    arrows: BoolProperty(name="Arrows", description="Heads on the lines that point with the flow", default=False)
    topology: BoolProperty(
        name="Topology First",
        description="Draw whole periodic orbits and separatrices first, and fit all other lines between them",
        default=True,
    )

    def start(self, context, obj):
        field = read_current(context, obj)
        settings = Settings(self.density, self.width, self.taper, self.arrows, self.topology)
        return streamline_steps(field.mesh, field.values, settings)

    def finish(self, context, obj, drawing):
        curves = make_curves(
            ROLE,
            drawing.curves,
            drawing.attributes,
            drawing.radii,
            cyclic=drawing.closed,
            curve_attributes=drawing.curve_attributes,
            parent=obj,
            material=flow_lines(),
        )
        if drawing.quiet_area > 0.0:
            self.report({"WARNING"}, f"The field is zero on {drawing.quiet_area:.1%} of the surface: no lines there")
        if drawing.gaps:
            self.report({"WARNING"}, f"{drawing.gaps} small places could not be reached by a line")
        self.report({"INFO"}, f"'{curves.name}' has {drawing.lines} lines, {int(drawing.closed.sum())} of them closed")


CLASSES = (STORMFIELD_OT_streamlines,)
