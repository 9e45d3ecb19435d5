# SPDX-License-Identifier: GPL-3.0-or-later
"""One edit of the solved field, as data: model/edits.py says what it means. Solve applies the list in its order."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .overridable import overridable

TYPES = (
    ("cancel", "Cancel", "Two entities vanish together; what must remain of them is said before"),
    ("simplify", "Simplify", "Pairs are cancelled, the least persistent first, until so many entities are left"),
    ("move", "Move", "A fixed point stands in another place; all else that the analysis shows stays"),
    ("smooth", "Smooth", "A region becomes as smooth as what is around it allows"),
    ("transform", "Transform", "The field turns, grows or stretches over λ"),
)
FIELDS = (
    ("both", "Both", "Orientation and advection"),
    ("orientation", "Orientation", "What turns the texture"),
    ("advection", "Advection", "What moves the texture"),
)
REGIONS = (
    ("ALL", "Everywhere", "The whole surface; of transform alone"),
    ("DISC", "Disc", "Around a point, as far as the radius"),
    ("LOOP", "Loop", "What a closed curve on the surface encloses"),
    ("FACES", "Faces", "Faces whose attribute, a boolean, is on"),
    ("GROUP", "Vertex Group", "Faces all of whose vertices have a weight of at least a half"),
)
AXES = (
    ("FIELD", "Orientation Field", "The direction of the orientation field at each place"),
    ("X", "X", "The object's X axis, laid into the surface"),
    ("Y", "Y", "The object's Y axis, laid into the surface"),
    ("Z", "Z", "The object's Z axis, laid into the surface"),
    ("CURVE", "Drawn Axis", "From the first point of a curve to its last, laid into the surface"),
)


def _is_line(_self, obj: bpy.types.Object) -> bool:
    return obj.type in {"CURVE", "CURVES", "GREASEPENCIL"}


def _changed(edit, _context) -> None:
    """What became of it before is no longer true: it waits."""
    edit.status = edit.reason = ""


@overridable
class EditProperties(bpy.types.PropertyGroup):
    name: StringProperty(name="Name", description="What the edit is called in the list; it changes nothing")
    type: EnumProperty(name="Edit", description="What is done to the field", items=TYPES, update=_changed)
    enabled: BoolProperty(name="On", description="Whether Solve applies this edit", default=True, update=_changed)
    field: EnumProperty(name="Field", description="Which of the two fields is edited", items=FIELDS, update=_changed)
    lam: FloatProperty(
        name="λ",
        description="Where it acts, at the λ sample nearest to this one; where Smooth and Transform begin (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        precision=4,
        update=_changed,
    )
    lam_end: FloatProperty(
        name="Until λ",
        description="The last λ that is smoothed, or where a transform is whole (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        precision=4,
        update=_changed,
    )
    reach: FloatProperty(
        name="Reach",
        description="How far along λ the change fades out; 0 changes one sample alone (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.1,
        precision=3,
        update=_changed,
    )
    keep: IntProperty(
        name="Keep", description="Fixed points and orbits that are left (count)", min=1, default=12, update=_changed
    )
    to: FloatVectorProperty(
        name="To",
        description="Where the point shall be, in the object's space (mesh units)",
        subtype="XYZ",
        update=_changed,
    )
    region: EnumProperty(
        name="Region", description="Where the field is changed", items=REGIONS, default="DISC", update=_changed
    )
    center: FloatVectorProperty(
        name="Center",
        description="Middle of the disc, in the object's space (mesh units)",
        subtype="XYZ",
        update=_changed,
    )
    radius: FloatProperty(
        name="Radius",
        description="Of the disc, in a straight line (mesh units)",
        min=0.0,
        default=0.2,
        precision=3,
        update=_changed,
    )
    loop: PointerProperty(
        name="Loop", description="The curve around the region", type=bpy.types.Object, poll=_is_line, update=_changed
    )
    faces: StringProperty(
        name="Attribute", description="Name of a boolean attribute of faces, or of a vertex group", update=_changed
    )
    falloff: FloatProperty(
        name="Falloff",
        description="Length around the region within which the transform fades out (mesh units)",
        min=0.0,
        precision=3,
        update=_changed,
    )
    angle: FloatProperty(
        name="Angle",
        description="How far all vectors turn, counter-clockwise seen from outside. Keyframe it, or it grows evenly "
        "from the first λ to the last (degrees)",
        default=0.0,
        step=100,
        precision=1,
        options={"ANIMATABLE"},
        update=_changed,
    )
    scale: FloatProperty(
        name="Scale",
        description="What all lengths are multiplied by. Keyframe it, or it grows evenly from 1 (factor)",
        default=1.0,
        min=1e-3,
        soft_max=10.0,
        precision=3,
        options={"ANIMATABLE"},
        update=_changed,
    )
    stretch: FloatProperty(
        name="Stretch",
        description="What lengths along the axis are multiplied by. Keyframe it, or it grows evenly from 1 (factor)",
        default=1.0,
        min=1e-3,
        soft_max=10.0,
        precision=3,
        options={"ANIMATABLE"},
        update=_changed,
    )
    axis: EnumProperty(name="Axis", description="Along what is stretched", items=AXES, update=_changed)
    axis_curve: PointerProperty(
        name="Drawn Axis",
        description="A curve whose ends are the axis",
        type=bpy.types.Object,
        poll=_is_line,
        update=_changed,
    )
    frozen: BoolProperty(
        name="Frozen",
        description="Transform the field as it is at the first λ, which stays from there on",
        update=_changed,
    )
    first_kind: StringProperty(name="First", description="Kind of the first entity", options={"HIDDEN"})
    first_at: FloatVectorProperty(name="First Place", description="A place near it (mesh units)", options={"HIDDEN"})
    second_kind: StringProperty(name="Second", description="Kind of the second entity", options={"HIDDEN"})
    second_at: FloatVectorProperty(name="Second Place", description="A place near it (mesh units)", options={"HIDDEN"})
    status: StringProperty(
        name="Status", description="applied or refused, at the last Solve; empty before", options={"HIDDEN"}
    )
    reason: StringProperty(
        name="Reason", description="What of the edit was not done at the last Solve, and why", options={"HIDDEN"}
    )


CLASSES = (EditProperties,)
