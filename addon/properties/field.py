# SPDX-License-Identifier: GPL-3.0-or-later
"""The root of all settings of one field, on its mesh object."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..scene.write import selection, turning
from .analysis import AnalysisProperties
from .bake import BakeProperties
from .edit import EditProperties
from .element import ElementProperties
from .look import LookProperties
from .morse import MorseProperties
from .overridable import overridable
from .solve import SolveProperties

SPEEDS = (
    ("TEXTURE", "Texture", "Where the surface is stretched the field is faster, as the texture on it is"),
    ("WORLD", "World", "The field is as fast as on the mesh at rest, however the surface is stretched"),
)


def _set_speed(field, _context) -> None:
    turning.set_speed(field.id_data)


def _element_chosen(self, _context) -> None:
    selection.show_element(self.id_data)


def _tell_blender(self, _context) -> None:
    """Blender does not see by itself that a script has set λ."""
    self.id_data.update_tag()


@overridable
class FieldProperties(bpy.types.PropertyGroup):
    enabled: BoolProperty(name="Has Field", description="Stormfield designs a field on this mesh", default=False)
    lam: FloatProperty(
        name="Time along Design (λ)",
        description="How far the design has come: λ, from 0 at its begin to 1 at its end (no unit). Keyframe it: the "
        "F-curve sets how fast the field changes in time, and changing it needs no new solve",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=4,
        step=1,
        subtype="FACTOR",
        options={"ANIMATABLE"},
        update=_tell_blender,
    )
    paused: StringProperty(
        name="Paused",
        description="Caches that are turned off while the mesh is another one than they were made for",
        options={"HIDDEN"},
    )
    doubts: StringProperty(
        name="Doubts", description="What is to be known of the last solve (JSON)", options={"HIDDEN"}
    )
    left_out: IntProperty(
        name="Left Out", description="Parts without an element that may stay so (count)", options={"HIDDEN"}
    )
    speed_on: EnumProperty(
        name="Keep Speed of",
        description="What a speed means on a surface that armatures, shape keys or other modifiers stretch",
        items=SPEEDS,
        update=_set_speed,
    )
    elements: CollectionProperty(type=ElementProperties)
    active_element: IntProperty(
        name="Active Element", description="Index of the element shown below the list", update=_element_chosen
    )
    edits: CollectionProperty(
        type=EditProperties, name="Edits", description="What Solve changes in the field after solving, in this order"
    )
    edited: StringProperty(
        name="Edited", description="The edits of a given field that were applied last", options={"HIDDEN"}
    )
    active_edit: IntProperty(name="Active Edit", description="Index of the edit shown below the list")
    cache_name: StringProperty(
        name="Cache Name", description="Name of the folder of this object's caches; it stays when the object is renamed"
    )
    solve: PointerProperty(type=SolveProperties)
    bake: PointerProperty(type=BakeProperties)
    look: PointerProperty(type=LookProperties)
    analysis: PointerProperty(type=AnalysisProperties)
    morse: PointerProperty(type=MorseProperties)

    def active(self) -> ElementProperties | None:
        return self.elements[self.active_element] if 0 <= self.active_element < len(self.elements) else None

    def chosen_edit(self) -> EditProperties | None:
        return self.edits[self.active_edit] if 0 <= self.active_edit < len(self.edits) else None
