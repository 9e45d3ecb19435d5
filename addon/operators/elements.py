# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of design elements: add from what is selected, place at the cursor, remove, move, preset."""

import bpy
from bpy.props import EnumProperty, IntProperty
from mathutils import Matrix

from ..model.element_types import RULES, ElementType
from ..properties.element import BIFURCATION_KINDS, KINDS, SOURCES, TYPES
from ..scene.read.active_field import active_field
from ..scene.write import selection
from ..scene.write.elements import add_element, default_radius
from .shared import ElementOperator, FieldOperator

#: What artists ask for by name: element settings in one click.
PRESETS: dict[str, tuple[str, str, dict[str, object]]] = {
    "MERGE": ("Merge", "Two storms that meet and go on as one", {"type": "singular", "kind": "vortex_ccw"}),
    "CYCLONE": ("Cyclone", "Turns left and flows in", {"type": "singular", "kind": "spiral_in_ccw"}),
    "ANTICYCLONE": ("Anticyclone", "Turns right and flows out", {"type": "singular", "kind": "spiral_out_cw"}),
    "EYE": ("Still Eye", "Turns left without flowing in or out", {"type": "singular", "kind": "vortex_ccw"}),
    "SPRING": ("Spring", "Everything flows away from here", {"type": "singular", "kind": "source"}),
    "DRAIN": ("Drain", "Everything flows to here", {"type": "singular", "kind": "sink"}),
    "SADDLE": ("Crossing", "Two streams meet and part (a saddle)", {"type": "singular", "kind": "saddle"}),
    "JET": ("Jet", "A fast stream along the curve", {"type": "streamline", "strength": 0.5}),
    "CALM": ("Calm Stream", "A slow stream along the curve", {"type": "streamline", "strength": 0.08}),
    "PARTICLE": ("Particle Path", "A particle travels along the curve in the time of the design", {"type": "pathline"}),
    "WIND": ("Wind", "The flow has the direction of the curve there", {"type": "regular"}),
}
#: Radius of a new bifurcation, whose pair comes a radius apart, over that of other elements.
BIFURCATION_SIZE = 3.0
#: Types that a selected empty cannot mean: it becomes a storm.
NEED_CURVES = frozenset({"streamline", "pathline", "orbit", "brush"})
#: Custom property of an object that says which preset it stands for, as those of the asset library have it.
PRESET_MARK = "stormfield_preset"
PRESET_ITEMS = tuple((key, label, text) for key, (label, text, _settings) in PRESETS.items())


def is_animated(obj: bpy.types.Object) -> bool:
    """Whether the object, or one of its parents, moves by keys, drivers or constraints."""
    holder: bpy.types.Object | None = obj
    while holder is not None:
        animation = holder.animation_data
        if (animation and (animation.action or animation.drivers)) or holder.constraints:
            return True
        holder = holder.parent
    return False


class STORMFIELD_OT_add_elements(FieldOperator, bpy.types.Operator):
    """Make every selected curve and empty an element of the field"""

    bl_idname = "stormfield.add_elements"
    bl_label = "Add from Selected"
    bl_options = {"REGISTER", "UNDO"}

    type: EnumProperty(name="Curves Mean", description="What a selected curve means", items=TYPES, default="streamline")
    kind: EnumProperty(name="Kind", description="How the field flows around a fixed point", items=KINDS)

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not _selected_sources(context):
            cls.poll_message_set("Select a curve or an empty that is no element yet")
            return False
        return True

    def execute(self, context):
        obj = active_field(context)
        sources = _selected_sources(context)
        for source in sources:
            point = source.type == "EMPTY"
            meaning: ElementType = "singular" if point and self.type in NEED_CURVES else self.type
            animated = point and is_animated(source) and not _moves_with(source, obj)
            settings: dict[str, object] = {
                "kind": self.kind,
                "type": meaning,
                "from_animation": animated and not RULES[meaning].instant,
            }
            if source.get(PRESET_MARK) in PRESETS:  # from the asset library: it says itself what it is
                settings |= PRESETS[source[PRESET_MARK]][2]
            add_element(obj, source, **settings)
        self.report({"INFO"}, f"Added {len(sources)} element{'s' if len(sources) != 1 else ''} to '{obj.name}'")
        return {"FINISHED"}


def _selected_sources(context) -> list[bpy.types.Object]:
    obj = active_field(context)
    known = {element.source for element in obj.stormfield.elements}
    return [
        s
        for s in context.selected_objects
        if s.type in SOURCES and s != obj and s not in known and not s.stormfield.enabled
    ]


def _moves_with(source, obj) -> bool:
    return source.parent == obj and not (source.animation_data or source.constraints)


class STORMFIELD_OT_place_element(FieldOperator, bpy.types.Operator):
    """Place an empty on the surface nearest to the 3D cursor and make it a fixed point of the field"""

    bl_idname = "stormfield.place_element"
    bl_label = "Place at Cursor"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(name="Kind", description="How the field flows around the point", items=KINDS)

    def execute(self, context):
        label = next(label for key, label, *_ in KINDS if key == self.kind)
        return _place_at_cursor(self, context, label.split(",")[0], type="singular", kind=self.kind)


class STORMFIELD_OT_place_bifurcation(FieldOperator, bpy.types.Operator):
    """Place an empty on the surface nearest to the 3D cursor, where a bifurcation happens at the present λ"""

    bl_idname = "stormfield.place_bifurcation"
    bl_label = "Place Bifurcation at Cursor"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(name="Kind", description="What happens there", items=BIFURCATION_KINDS)

    def execute(self, context):
        label = next(label for key, label, *_ in BIFURCATION_KINDS if key == self.kind)
        obj = active_field(context)
        lam = obj.stormfield.lam
        return _place_at_cursor(
            self,
            context,
            label,
            type="bifurcation",
            bifurcation_kind=self.kind,
            radius=BIFURCATION_SIZE * default_radius(obj),
            lam_start=lam if 0.05 < lam < 0.95 else 0.5,
        )


def _place_at_cursor(operator, context, name: str, **settings) -> set[str]:
    """An element at a new empty, whose X axis lies along the surface."""
    obj = active_field(context)
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    inverse = obj.matrix_world.inverted_safe()
    found, place, normal, _face = obj.closest_point_on_mesh(inverse @ context.scene.cursor.location)
    if not found:
        operator.report({"ERROR"}, f"'{obj.name}' has no surface near the 3D cursor")
        return {"CANCELLED"}
    empty = bpy.data.objects.new(name, None)
    empty.empty_display_type, empty.empty_display_size = "ARROWS", default_radius(obj)
    empty.parent = obj
    empty.matrix_basis = Matrix.Translation(place) @ normal.to_track_quat("Z", "Y").to_matrix().to_4x4()
    for collection in obj.users_collection or [context.scene.collection]:
        collection.objects.link(empty)
    add_element(obj, empty, **settings)
    return {"FINISHED"}


class STORMFIELD_OT_remove_element(ElementOperator, bpy.types.Operator):
    """Take the active element out of the list; its curve or empty stays in the scene"""

    bl_idname = "stormfield.remove_element"
    bl_label = "Remove Element"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        field = active_field(context).stormfield
        field.elements.remove(field.active_element)
        field.active_element = max(0, min(field.active_element, len(field.elements) - 1))
        return {"FINISHED"}


class STORMFIELD_OT_select_element(FieldOperator, bpy.types.Operator):
    """Select this element in the list, and its curve or empty in the view"""

    bl_idname = "stormfield.select_element"
    bl_label = "Select Element"
    bl_options = {"UNDO", "INTERNAL"}

    index: IntProperty(name="Element", description="Its place in the list (count)", min=0)

    def execute(self, context):
        obj = active_field(context)
        if self.index >= len(obj.stormfield.elements):
            self.report({"WARNING"}, f"There is no element {self.index}; choose one in the list")
            return {"CANCELLED"}
        obj.stormfield.active_element = self.index
        selection.select_source(obj)
        return {"FINISHED"}


class STORMFIELD_OT_move_element(ElementOperator, bpy.types.Operator):
    """Move the active element in the list; the order counts for brush strokes only, which act one after the other"""

    bl_idname = "stormfield.move_element"
    bl_label = "Move Element"
    bl_options = {"REGISTER", "UNDO"}

    direction: EnumProperty(items=(("UP", "Up", "Towards the top"), ("DOWN", "Down", "Towards the bottom")))

    def execute(self, context):
        field = active_field(context).stormfield
        goal = field.active_element + (-1 if self.direction == "UP" else 1)
        if not 0 <= goal < len(field.elements):
            return {"CANCELLED"}
        field.elements.move(field.active_element, goal)
        field.active_element = goal
        return {"FINISHED"}


class STORMFIELD_OT_element_preset(ElementOperator, bpy.types.Operator):
    """Give the active element the settings of one of these kinds of flow"""

    bl_idname = "stormfield.element_preset"
    bl_label = "Element Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(items=PRESET_ITEMS)

    def execute(self, context):
        element = active_field(context).stormfield.active()
        for key, value in PRESETS[self.preset][2].items():
            setattr(element, key, value)
        return {"FINISHED"}


CLASSES = (
    STORMFIELD_OT_add_elements,
    STORMFIELD_OT_place_element,
    STORMFIELD_OT_place_bifurcation,
    STORMFIELD_OT_remove_element,
    STORMFIELD_OT_select_element,
    STORMFIELD_OT_move_element,
    STORMFIELD_OT_element_preset,
)
