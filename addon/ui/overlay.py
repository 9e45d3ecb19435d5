# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport overlay: strokes of the field at the current λ, its fixed points, what an analysis found, a legend.

Draw handlers only read. The surface hides what lies behind it; markers keep their size on screen at any zoom.
"""

from collections import Counter

import bpy
import gpu
import numpy as np
from mathutils import Matrix

from ..scene.read.active_field import active_field
from . import (
    analysis_overlay,
    drawing_cache,
    edit_overlay,
    element_overlay,
    legend,
    marker_drawing,
    markers,
    motion,
    out_of_date,
    stroke_shader,
    view_text,
)
from .marker_drawing import Marker
from .stroke_shader import StrokeLook
from .stroke_view import View

mark_changed = drawing_cache.mark_changed

#: Width of the dark rim around strokes, pixels at 100 % interface scale.
RIM = 1.2

_handles: list = []


def forget() -> None:
    analysis_overlay.forget()
    edit_overlay.forget()
    element_overlay.forget()
    motion.forget()
    legend.forget()
    marker_drawing.forget()
    view_text.forget()


def register() -> None:
    if bpy.app.background or _handles:
        return
    space = bpy.types.SpaceView3D
    _handles.append(space.draw_handler_add(_draw_guarded, (draw_field,), "WINDOW", "POST_VIEW"))
    _handles.append(space.draw_handler_add(_draw_guarded, (draw_texts,), "WINDOW", "POST_PIXEL"))


def unregister() -> None:
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    forget()
    stroke_shader.release()


def _draw_guarded(draw) -> None:
    """Leave the GPU as it was found, whatever happens in between."""
    context = bpy.context
    if not context.space_data.overlay.show_overlays:
        return
    gpu.state.depth_mask_set(False)  # what is drawn later is not hidden by what was drawn before
    try:
        draw(context)
    finally:
        gpu.state.depth_test_set("NONE")
        gpu.state.depth_mask_set(False)
        gpu.state.blend_set("NONE")


def draw_field(context: bpy.types.Context) -> None:
    for obj, evaluated in _shown_objects(context):
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        drawing = drawing_cache.drawing_of(evaluated)
        if drawing is not None:
            _draw_strokes(context, evaluated, obj.stormfield.look)
        if obj.stormfield.look.show_elements:
            element_overlay.draw(context, obj, evaluated)
        analysis_overlay.draw(context, obj, evaluated)
        if drawing is not None:
            points = (Marker(kind, position) for kind, position in drawing.points)
            marker_drawing.draw(context, evaluated.matrix_world, points)
        edit_overlay.draw(context, obj, evaluated)


def _shown_objects(context):
    """Visible objects with a field and the overlay on, with what the dependency graph made of them."""
    depsgraph = context.view_layer.depsgraph
    for obj in context.view_layer.objects:
        if obj.type != "MESH" or not obj.stormfield.enabled or not obj.stormfield.look.show_overlay:
            continue
        if obj.mode == "EDIT" or not obj.visible_get(view_layer=context.view_layer, viewport=context.space_data):
            continue
        yield obj, obj.evaluated_get(depsgraph)


def _draw_strokes(context, evaluated, look) -> None:
    if look.style == "NONE":
        return
    unit, region = context.preferences.system.ui_scale, context.region
    view = view_of(context, evaluated.matrix_world)
    spacing = look.spacing * unit
    batch = drawing_cache.strokes_of(evaluated, region.as_pointer(), view, spacing, look.length)
    batch.draw(
        context.region_data.perspective_matrix @ evaluated.matrix_world,
        view.size,
        view.scale,
        StrokeLook(
            distance=spacing,
            length=spacing * look.length,
            width=look.width * unit,
            rim=RIM * unit,
            opacity=look.opacity,
            arrows=look.style == "ARROWS",
            phase=motion.phase(context) if look.show_motion else None,
        ),
    )


def view_of(context: bpy.types.Context, matrix_world: Matrix) -> View:
    """How the region sees an object."""
    region, seen = context.region, context.region_data
    camera = np.array(matrix_world.inverted_safe() @ seen.view_matrix.inverted())
    eye = camera.T[3 if seen.is_perspective else 2]
    size = float(np.mean([axis.length for axis in matrix_world.to_3x3().col]))
    return View(
        projection=np.array(seen.perspective_matrix @ matrix_world),
        size=(float(region.width), float(region.height)),
        scale=0.5 * region.height * np.linalg.norm(np.array(seen.window_matrix)[1, :3]) * size,
        eye=eye,
    )


def draw_texts(context: bpy.types.Context) -> None:
    """Names of entities, and the legend of the active field."""
    shown = dict(_shown_objects(context))
    for obj, evaluated in shown.items():
        if obj.stormfield.look.show_elements:
            element_overlay.draw_names(context, obj, evaluated)
        analysis_overlay.draw_names(context, obj, evaluated)
        sentence = out_of_date.sentence(obj)
        if sentence:
            _write_above(context, evaluated, sentence)
    obj = active_field(context)
    if obj in shown and obj.stormfield.look.show_legend:
        blocks = [*_field_block(obj, shown[obj]), *analysis_overlay.legend_blocks(obj, shown[obj])]
        if blocks:
            legend.draw(context, blocks, obj.stormfield.look.legend_folded)


def _write_above(context, evaluated, text: str) -> None:
    """Over the object, kept inside the view."""
    corners = np.array([corner[:] for corner in evaluated.bound_box])
    places = marker_drawing.on_screen(context, evaluated.matrix_world, corners)
    if not np.isfinite(places).any():
        return
    unit, region = context.preferences.system.ui_scale, context.region
    x = float(np.clip(np.nanmin(places[:, 0]), 60 * unit, max(region.width - 420 * unit, 60 * unit)))
    y = float(np.clip(np.nanmax(places[:, 1]) + 12 * unit, 60 * unit, region.height - 90 * unit))
    view_text.write([view_text.Word(text, x, y)], unit)


def _field_block(obj, evaluated) -> list[legend.Block]:
    drawing = drawing_cache.drawing_of(evaluated)
    if drawing is None:
        return []
    look = obj.stormfield.look
    counts = Counter(kind for kind, _position in drawing.points)
    rows = tuple((kind, f"{name}  {counts[kind]}") for kind, name in markers.NAMES.items() if counts[kind])
    if not look.show_fixed_points or drawing.note:
        rows = ()
    label = "Advection" if look.shown_field == "sf_advection" else "Orientation"
    return [legend.Block(f"{label}  λ {obj.stormfield.lam:.3f}", rows)]
