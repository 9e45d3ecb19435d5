# SPDX-License-Identifier: GPL-3.0-or-later
"""A click on an entity in the 3D view selects it, with every tool: a gizmo without a picture of its own.

Blender asks the gizmo first whether something of it lies under the pointer, so that a click that hits no marker does
what it always does. Bifurcations, Morse sets and entities can be hit at their markers, orbits and paths along their
lines; what the surface hides cannot.
"""

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Vector

from ..scene.read import results
from ..scene.read.active_field import active_field
from . import analysis_drawing, analysis_overlay, element_drawing, legend, marker_drawing, motion

#: How near the pointer must be to a marker and to a line (pixels at 100 % interface scale).
REACH, LINE_REACH = 11.0, 6.0
#: How far a marker is pulled before its point moves (the same).
PULL = 6.0


def entity_at(context: bpy.types.Context, obj, evaluated, pointer) -> tuple[str, int] | None:
    """List and place of the entity under the pointer (pixels of the region), the nearest first."""
    drawing = analysis_drawing.drawing_of(evaluated) if obj.stormfield.analysis.show else None
    if drawing is None:
        return None
    unit = context.preferences.system.ui_scale
    pointer = np.asarray(pointer, float)
    found: list[tuple[float, str, int, np.ndarray]] = []
    marks = analysis_overlay.visible_marks(obj, drawing)
    if marks:
        places = np.array([mark.position for mark in marks])
        away = np.linalg.norm(marker_drawing.on_screen(context, evaluated.matrix_world, places) - pointer, axis=1)
        near = np.flatnonzero(away < REACH * unit)
        found += [(away[i], marks[i].which, marks[i].index, places[i]) for i in near]
    for role, which, shown in _lines_to_hit(obj):
        lines = drawing.lines.get(role)
        if lines is None or not shown:
            continue
        away, places = _distance_to_lines(context, evaluated.matrix_world, lines.ends, pointer)
        nearest = int(np.argmin(away))
        if away[nearest] < LINE_REACH * unit:  # after any marker
            owner = int(lines.owners[nearest, 0])
            found.append((REACH * unit + away[nearest], which, owner, places[nearest]))
    for _, which, index, place in sorted(found, key=lambda hit: hit[0]):
        if not _hidden(context, evaluated, place):
            return which, index
    return None


def element_at(context: bpy.types.Context, obj, evaluated, pointer) -> int | None:
    """Place in the list of the element whose path, ring or sign is under the pointer, the nearest one."""
    reach = LINE_REACH * context.preferences.system.ui_scale
    found: list[tuple[float, int]] = []
    for shape in element_drawing.drawing_of(evaluated).shapes:
        ends = np.concatenate([shape.fixed, shape.at(evaluated.stormfield.lam)])
        if not len(ends):
            continue
        away, places = _distance_to_lines(context, evaluated.matrix_world, ends, np.asarray(pointer, float))
        nearest = int(np.argmin(away))
        if away[nearest] < reach and not _hidden(context, evaluated, places[nearest]):
            found.append((float(away[nearest]), shape.index))
    return min(found)[1] if found else None


def _lines_to_hit(obj):
    analysis = obj.stormfield.analysis
    current = analysis_drawing.is_current(obj, analysis.ecg)
    yield results.ORBITS, "ecg", analysis.show_orbits and current
    yield results.PATHS, "history", analysis.show_paths


def _distance_to_lines(context, matrix, ends: np.ndarray, pointer: np.ndarray):
    """(l,) pixels from the pointer to each segment, infinite behind the viewer, and the points (l, 3) next to it."""
    flat = marker_drawing.on_screen(context, matrix, ends.reshape(-1, 3)).reshape(-1, 2, 2)
    start, along = flat[:, 0], flat[:, 1] - flat[:, 0]
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    fraction = np.clip(((pointer - start) * along).sum(axis=1) / length, 0.0, 1.0)
    away = np.linalg.norm(start + fraction[:, None] * along - pointer, axis=1)
    places = ends[:, 0] + fraction[:, None] * (ends[:, 1] - ends[:, 0])
    return np.where(np.isfinite(away), away, np.inf), places


def _hidden(context, evaluated, place: np.ndarray) -> bool:
    """Whether the object itself is in front of a point of it."""
    world = evaluated.matrix_world @ Vector(place)
    pixel = view3d_utils.location_3d_to_region_2d(context.region, context.region_data, world)
    if pixel is None:
        return True
    origin = view3d_utils.region_2d_to_origin_3d(context.region, context.region_data, pixel)
    inverse = evaluated.matrix_world.inverted_safe()
    start, end = inverse @ origin, Vector(place)
    ray = end - start
    if ray.length == 0:
        return False
    slack = 4 * analysis_drawing.LIFT * max(evaluated.dimensions) / max(max(evaluated.matrix_world.to_scale()), 1e-9)
    return bool(evaluated.ray_cast(start, ray.normalized(), distance=max(ray.length - slack, 1e-6))[0])


class STORMFIELD_GT_entities(bpy.types.Gizmo):
    bl_idname = "STORMFIELD_GT_entities"
    __slots__ = ("element", "hit", "on_legend", "pressed")

    def draw(self, _context):
        """Nothing: the overlay draws the entities."""

    def test_select(self, context, location):
        obj = active_field(context)
        if obj is not None and obj.stormfield.look.show_motion and obj.stormfield.look.style != "NONE":
            motion.pointer_moved(context)
        if obj is None or obj.mode == "EDIT":
            return -1
        box = legend.box_in(context.region)
        self.on_legend = box is not None and box.holds(*location)
        if self.on_legend:
            return 0
        evaluated = obj.evaluated_get(context.view_layer.depsgraph)
        self.hit = entity_at(context, obj, evaluated, location)
        self.element = None
        if self.hit is None and obj.stormfield.look.show_elements and context.mode == "OBJECT":
            self.element = element_at(context, obj, evaluated, location)
        return -1 if self.hit is None and self.element is None else 0

    def invoke(self, context, event):
        if getattr(self, "on_legend", False):
            look = active_field(context).stormfield.look
            look.legend_folded = not look.legend_folded
            return {"FINISHED"}
        element = getattr(self, "element", None)
        if element is not None:
            bpy.ops.stormfield.select_element("INVOKE_DEFAULT", index=element)
            return {"FINISHED"}
        hit = getattr(self, "hit", None)
        if hit is None:
            return {"PASS_THROUGH"}
        bpy.ops.stormfield.select_entity("INVOKE_DEFAULT", which=hit[0], index=hit[1], extend=event.shift)
        if hit[0] != "ecg" or event.shift or not bpy.ops.stormfield.move_point.poll():
            return {"FINISHED"}
        self.pressed = event.mouse_region_x, event.mouse_region_y
        return {"RUNNING_MODAL"}

    def modal(self, context, event, _tweak):
        """A click has selected; pulling the marker away moves its point."""
        away = np.hypot(event.mouse_region_x - self.pressed[0], event.mouse_region_y - self.pressed[1])
        if event.type == "MOUSEMOVE" and away > PULL * context.preferences.system.ui_scale:
            bpy.ops.stormfield.move_point("INVOKE_DEFAULT", held=True)
            return {"FINISHED"}
        return {"FINISHED"} if event.type in {"LEFTMOUSE", "ESC", "RIGHTMOUSE"} else {"RUNNING_MODAL"}


class STORMFIELD_GGT_entities(bpy.types.GizmoGroup):
    bl_idname = "STORMFIELD_GGT_entities"
    bl_label = "Stormfield Entities"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "PERSISTENT"}

    @classmethod
    def poll(cls, context):
        obj = active_field(context)
        return obj is not None and obj.stormfield.look.show_overlay and context.space_data.overlay.show_overlays

    def setup(self, _context):
        gizmo = self.gizmos.new(STORMFIELD_GT_entities.bl_idname)
        gizmo.use_draw_modal = False
        gizmo.use_tooltip = False


CLASSES = (STORMFIELD_GT_entities, STORMFIELD_GGT_entities)
