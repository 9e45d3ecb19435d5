# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a region: smooth it, or turn, scale and stretch the field over λ there or everywhere."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from ..model.errors import InputError
from ..scene.read.active_field import active_field
from ..scene.read.regions import line_of, polygons_of, triangles_of
from ..work import Step
from .edit_choice import why_not_region
from .edit_operator import REACH, EditOperator

#: Name of the attribute of faces that a selection becomes.
REGION = "Flow Region"
SMOOTHED = (
    ("FACES", "Selected Faces", "The faces that are selected in Edit Mode"),
    ("LOOP", "Drawn Loop", "What the other selected object, a closed curve on the surface, encloses"),
    ("GROUP", "Vertex Group", "Faces all of whose vertices have a weight of at least a half in the active group"),
    ("DISC", "Around Entity", "Around the selected entity of the analysis, as far as the radius"),
)
EVERYWHERE = ("ALL", "Everywhere", "The whole surface")


class RegionOperator(EditOperator):
    """Mix-in of operators that change the field in a region. What was chosen is kept with the edit: a selection as an
    attribute of faces, which can be changed later."""

    why_not = staticmethod(why_not_region)

    def subject(self, context):
        if context.mode.startswith("EDIT"):
            bpy.ops.object.mode_set(mode="OBJECT")
        return active_field(context)

    def invoke(self, context, event):
        if not self.properties.is_property_set("region"):
            self.region = self.likely(context)
        return super().invoke(context, event)

    def likely(self, context) -> str:
        """The region that the artist most likely means."""
        obj = active_field(context)
        if context.mode == "EDIT_MESH":
            return "FACES"
        if _curve(context, obj) is not None:
            return "LOOP"
        return "DISC" if obj.stormfield.analysis.ecg.selected() is not None else "FACES"

    def start(self, context, obj):
        self._region, self._drawn = self._read_region(context, obj)
        return super().start(context, obj)

    def finish(self, context, obj, result):
        if self.region == "FACES":
            self._drawn["faces"] = _keep_selection(obj)
        super().finish(context, obj, result)

    def drawn(self):
        return self._drawn

    def _read_region(self, context, obj) -> tuple[dict, dict]:
        """As edits.schema.json has it, and as the list keeps it."""
        match self.region:
            case "ALL":
                return {}, {"region": "ALL"}
            case "DISC":
                item = obj.stormfield.analysis.ecg.selected()
                if item is None:
                    raise InputError("Select an entity in list or view first: the disc lies around it")
                return {"region": {"center": list(item.position), "radius": self.radius}}, {}
            case "LOOP":
                curve = _curve(context, obj)
                if curve is None:
                    raise InputError(f"Select a closed curve on '{obj.name}' as well, the mesh last")
                line = line_of(context, obj, curve, "The loop")
                closed = len(line) > 1 and np.allclose(line[0], line[-1])
                return {"region": {"loop": line[: -1 if closed else None].tolist()}}, {"region": "LOOP", "loop": curve}
            case "GROUP":
                group = obj.vertex_groups.active
                if group is None:
                    raise InputError(f"'{obj.name}' has no vertex group; make one, or select faces")
                kept = {"region": "GROUP", "faces": group.name}
                return {"region": {"faces": _faces_of_group(obj, group.name)}}, kept
            case _:
                chosen = triangles_of(obj, _selected(obj))
                if not len(chosen):
                    raise InputError(f"Select faces of '{obj.name}' in Edit Mode first")
                return {"region": {"faces": chosen.tolist()}}, {"region": "FACES"}


class STORMFIELD_OT_smooth_region(RegionOperator, bpy.types.Operator):
    """Make the field in a region as smooth as what is around it allows: selected faces, what a drawn loop encloses, or
    a disc around an entity. What is outside keeps its bits. Esc stops"""

    bl_idname = "stormfield.smooth_region"
    bl_label = "Smooth Region"
    bl_options = {"REGISTER", "UNDO"}

    region: EnumProperty(name="Region", description="What is smoothed", items=SMOOTHED, options={"SKIP_SAVE"})
    radius: FloatProperty(
        name="Radius", description="Of the disc, in a straight line (mesh units)", min=1e-6, default=0.2, precision=3
    )
    reach: FloatProperty(**REACH)

    def propose(self, _sample):
        yield Step(0.0, "Smoothing")
        return {"type": "smooth", **self._region, "reach": self.reach}

    def title(self, _edit):
        return f"Smooth {_noun(self.region)}"


class STORMFIELD_OT_transform_field(RegionOperator, bpy.types.Operator):
    """Turn, scale or stretch the field over λ, everywhere or in a region. Its values can be keyframed in the list
    afterwards. Esc stops"""

    bl_idname = "stormfield.transform_field"
    bl_label = "Transform"
    bl_options = {"REGISTER", "UNDO"}

    region: EnumProperty(name="Region", description="What is transformed", items=(EVERYWHERE, *SMOOTHED), default="ALL")
    radius: FloatProperty(
        name="Radius", description="Of the disc, in a straight line (mesh units)", min=1e-6, default=0.2, precision=3
    )
    falloff: FloatProperty(
        name="Falloff",
        description="Length around the region within which it fades out (mesh units)",
        min=0.0,
        default=0.1,
        precision=3,
    )
    angle: FloatProperty(
        name="Angle",
        description="How far all vectors turn, counter-clockwise seen from outside (degrees)",
        default=90.0,
        step=100,
        precision=1,
    )
    scale: FloatProperty(name="Scale", description="What all lengths are multiplied by (factor)", default=1.0, min=1e-3)
    stretch: FloatProperty(
        name="Stretch",
        description="What lengths along the orientation field are multiplied by (factor)",
        default=1.0,
        min=1e-3,
    )
    lam_start: FloatProperty(
        name="From λ", description="Where it begins (0..1)", subtype="FACTOR", min=0.0, max=1.0, default=0.0
    )
    lam_end: FloatProperty(
        name="Until λ",
        description="Where it is whole, and stays (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=1.0,
    )
    frozen: BoolProperty(
        name="Frozen", description="Transform the field as it is at the first λ, which stays from there on"
    )

    def likely(self, _context):
        return "ALL"

    def propose(self, _sample):
        yield Step(0.0, "Turning")
        given = {"angle": (self.angle, 0.0), "scale": (self.scale, 1.0), "stretch": (self.stretch, 1.0)}
        changes = {name: value for name, (value, nothing) in given.items() if value != nothing}
        if not changes:
            raise InputError("The transform changes nothing: give an angle, a scale or a stretch")
        lam = [self.lam_start, self.lam_end] if self.lam_end > self.lam_start else self.lam_start
        fades = {"falloff": self.falloff} if self._region else {}
        return {"type": "transform", **changes, **self._region, **fades, "lam": lam, "frozen": self.frozen}

    def drawn(self):
        own = {name: getattr(self, name) for name in ("angle", "scale", "stretch", "frozen", "falloff")}
        return {**super().drawn(), **own}

    def title(self, _edit):
        parts = [f"Turn {self.angle:g}°"] if self.angle else []
        parts += [f"Scale {self.scale:g}"] if self.scale != 1.0 else []
        parts += [f"Stretch {self.stretch:g}"] if self.stretch != 1.0 else []
        return ", ".join(parts)


def _noun(region: str) -> str:
    return next(label for key, label, _text in SMOOTHED if key == region)


def _curve(context, obj) -> bpy.types.Object | None:
    """The selected curve besides the field's object."""
    kinds = {"CURVE", "CURVES", "GREASEPENCIL"}
    return next((other for other in context.selected_objects if other.type in kinds and other != obj), None)


def _selected(obj) -> np.ndarray:
    selected = np.empty(len(obj.data.polygons), bool)
    obj.data.polygons.foreach_get("select", selected)
    return selected


def _keep_selection(obj) -> str:
    """The selected faces as an attribute; its name."""
    attribute = obj.data.attributes.new(REGION, "BOOLEAN", "FACE")
    attribute.data.foreach_set("value", _selected(obj))
    return attribute.name


def _faces_of_group(obj, name: str) -> list[int]:
    chosen = triangles_of(obj, polygons_of(obj, "GROUP", name, "The region"))
    if not len(chosen):
        raise InputError(f"The vertex group '{name}' holds no whole face with weights of a half or more")
    return chosen.tolist()


CLASSES = (STORMFIELD_OT_smooth_region, STORMFIELD_OT_transform_field)
