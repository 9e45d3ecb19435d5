# SPDX-License-Identifier: GPL-3.0-or-later
"""One edit of the solved field, as data: model/edits.py says what it means. Solve applies the list in its order."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty

from .overridable import overridable

TYPES = (
    ("cancel", "Cancel", "Two entities vanish together; what must remain of them is said before"),
    ("simplify", "Simplify", "Pairs are cancelled, the least persistent first, until so many entities are left"),
)
FIELDS = (
    ("both", "Both", "Orientation and advection"),
    ("orientation", "Orientation", "What turns the texture"),
    ("advection", "Advection", "What moves the texture"),
)


@overridable
class EditProperties(bpy.types.PropertyGroup):
    name: StringProperty(name="Name", description="What the edit is called in the list; it changes nothing")
    type: EnumProperty(name="Edit", description="What is done to the field", items=TYPES)
    enabled: BoolProperty(name="On", description="Whether Solve applies this edit", default=True)
    field: EnumProperty(name="Field", description="Which of the two fields is edited", items=FIELDS)
    lam: FloatProperty(
        name="λ",
        description="Where it acts: at the λ sample nearest to this one (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        precision=4,
    )
    reach: FloatProperty(
        name="Reach",
        description="How far along λ the change fades out; 0 changes one sample alone (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.1,
        precision=3,
    )
    keep: IntProperty(name="Keep", description="Fixed points and orbits that are left (count)", min=1, default=12)
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
