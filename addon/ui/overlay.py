# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport overlay: strokes of the field at the current λ, its fixed points, what an analysis found, a legend.

Draw handlers only read. The surface hides what lies behind it; markers keep their size on screen at any zoom.
"""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from ..scene.read.active_field import active_field
from . import analysis_overlay, drawing_cache, legend, marker_drawing, markers
from .marker_drawing import Marker

forget = analysis_overlay.forget
mark_changed = drawing_cache.mark_changed

_handles: list = []


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
            _draw_lines(context, evaluated, drawing, obj.stormfield.look)
        analysis_overlay.draw(context, obj, evaluated)
        if drawing is not None:
            points = (Marker(kind, position) for kind, position in drawing.points)
            marker_drawing.draw(context, evaluated.matrix_world, points)


def _shown_objects(context):
    """Visible objects with a field and the overlay on, with what the dependency graph made of them."""
    depsgraph = context.view_layer.depsgraph
    for obj in context.view_layer.objects:
        if obj.type != "MESH" or not obj.stormfield.enabled or not obj.stormfield.look.show_overlay:
            continue
        if obj.mode == "EDIT" or not obj.visible_get(view_layer=context.view_layer, viewport=context.space_data):
            continue
        yield obj, obj.evaluated_get(depsgraph)


def _draw_lines(context, evaluated, drawing, look) -> None:
    if not len(drawing.lines):
        return
    shader = compat.builtin_shader("POLYLINE_SMOOTH_COLOR")
    if drawing.batch is None:
        drawing.batch = batch_for_shader(
            shader,
            "LINES",
            {
                "pos": drawing.lines.reshape(-1, 3).astype(np.float32),
                "color": drawing.colours.reshape(-1, 4).astype(np.float32),
            },
        )
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(evaluated.matrix_world)
        shader.bind()
        shader.uniform_float("viewportSize", (context.region.width, context.region.height))
        shader.uniform_float("lineWidth", look.width * context.preferences.system.ui_scale)
        drawing.batch.draw(shader)


def draw_texts(context: bpy.types.Context) -> None:
    """Names of entities, and the legend of the active field."""
    shown = dict(_shown_objects(context))
    for obj, evaluated in shown.items():
        analysis_overlay.draw_names(context, obj, evaluated)
    obj = active_field(context)
    if obj in shown and obj.stormfield.look.show_legend:
        blocks = [*_field_block(obj, shown[obj]), *analysis_overlay.legend_blocks(obj, shown[obj])]
        if blocks:
            legend.draw(context, blocks)


def _field_block(obj, evaluated) -> list[legend.Block]:
    drawing = drawing_cache.drawing_of(evaluated)
    if drawing is None:
        return []
    look = obj.stormfield.look
    counts = {kind: 0 for kind in ("source", "sink", "saddle", "center")}
    for kind, _position in drawing.points:
        counts[kind] = counts.get(kind, 0) + 1
    rows = [(kind, f"{markers.NAMES[kind]}  {count}") for kind, count in counts.items()]
    if not look.show_fixed_points or drawing.note:
        rows = []
    label = "Advection" if look.shown_field == "sf_advection" else "Orientation"
    return [legend.Block(f"{label}  λ {obj.stormfield.lam:.3f}", rows)]
