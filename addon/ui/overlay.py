"""The viewport overlay: strokes of the field at the current λ, its fixed points and a legend.

Draw handlers only read. The surface hides what lies behind it; markers keep their size on screen at any zoom.
"""

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from ..operators.shared import active_field
from . import drawing_cache, markers

forget = drawing_cache.forget
mark_changed = drawing_cache.mark_changed

#: Radius of a marker on screen, in pixels at 100 % interface scale.
MARKER = 7.0
_handles: list = []


def register() -> None:
    if bpy.app.background or _handles:
        return
    space = bpy.types.SpaceView3D
    _handles.append(space.draw_handler_add(_draw_guarded, (draw_field,), "WINDOW", "POST_VIEW"))
    _handles.append(space.draw_handler_add(_draw_guarded, (draw_legend,), "WINDOW", "POST_PIXEL"))


def unregister() -> None:
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    drawing_cache.forget()


def _draw_guarded(draw) -> None:
    """Leave the GPU as it was found, whatever happens in between."""
    context = bpy.context
    if not context.space_data.overlay.show_overlays:
        return
    try:
        draw(context)
    finally:
        gpu.state.depth_test_set("NONE")
        gpu.state.depth_mask_set(False)
        gpu.state.blend_set("NONE")


def draw_field(context: bpy.types.Context) -> None:
    for obj, evaluated in _shown_objects(context):
        drawing = drawing_cache.drawing_of(evaluated)
        if drawing is None:
            continue
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        _draw_lines(context, evaluated, drawing, obj.stormfield.look)
        _draw_points(context, evaluated, drawing)


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


def _draw_points(context, evaluated, drawing) -> None:
    if not drawing.points:
        return
    view = context.region_data
    matrix = np.array(evaluated.matrix_world)
    perspective = np.array(view.perspective_matrix)
    axes = np.array(view.view_matrix.inverted())
    right, up, back = axes[:3, 0], axes[:3, 1], axes[:3, 2]
    eye = axes[:3, 3] if view.is_perspective else None
    pixels = MARKER * context.preferences.system.ui_scale
    scale = np.linalg.norm(np.array(view.window_matrix)[1, :3]) * context.region.height / 2.0
    corners, colours = [], []
    for kind, position in drawing.points:
        place = matrix[:3, :3] @ position + matrix[:3, 3]
        depth = float(perspective[3, :3] @ place + perspective[3, 3])
        if depth <= 0:
            continue
        radius = pixels * depth / scale
        towards = back if eye is None else (eye - place) / np.linalg.norm(eye - place)
        flat, colour = markers.triangles(kind)
        corners.append(place + radius * (flat[:, :1] * right + flat[:, 1:] * up) + 1.5 * radius * towards)
        colours.append(colour)
    if corners:
        shader = compat.builtin_shader("SMOOTH_COLOR")
        batch_for_shader(
            shader,
            "TRIS",
            {
                "pos": np.concatenate(corners).astype(np.float32),
                "color": np.concatenate(colours),
            },
        ).draw(shader)


def draw_legend(context: bpy.types.Context) -> None:
    obj = active_field(context)
    if obj is None or not obj.stormfield.look.show_legend:
        return
    shown = dict(_shown_objects(context))
    if obj not in shown:
        return
    drawing = drawing_cache.drawing_of(shown[obj])
    if drawing is None:
        return
    look, unit = obj.stormfield.look, context.preferences.system.ui_scale
    counts = {kind: 0 for kind in ("source", "sink", "saddle", "center")}
    for kind, _position in drawing.points:
        counts[kind] = counts.get(kind, 0) + 1
    rows = [(kind, f"{markers.KINDS[kind][0]}  {count}") for kind, count in counts.items()]
    if not look.show_fixed_points or drawing.note:
        rows = []
    label = "Advection" if look.shown_field == "sf_advection" else "Orientation"
    _legend(context, f"{label}   λ {obj.stormfield.lam:.3f}", rows, unit)


def _legend(context, title: str, rows, unit: float) -> None:
    """A quiet box in the lower right corner, left of the sidebar."""
    line, pad = 20.0 * unit, 10.0 * unit
    width, height = 150.0 * unit, line * (1 + len(rows)) + 2 * pad - 4 * unit
    sidebar = next((r.width for r in context.area.regions if r.type == "UI" and r.width > 1), 0)
    overlap = context.preferences.system.use_region_overlap
    left = context.region.width - (sidebar if overlap else 0) - width - 14 * unit
    bottom = 14 * unit
    shader = compat.builtin_shader("SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    box = [(left, bottom), (left + width, bottom), (left + width, bottom + height), (left, bottom + height)]
    batch_for_shader(
        shader,
        "TRIS",
        {
            "pos": [(*box[i], 0.0) for i in (0, 1, 2, 0, 2, 3)],
            "color": [(0.08, 0.08, 0.09, 0.72)] * 6,
        },
    ).draw(shader)
    y = bottom + height - pad - 11 * unit
    _write(title, left + pad, y, unit)
    for kind, text in rows:
        y -= line
        flat, colours = markers.triangles(kind)
        centre = np.array([left + pad + 7 * unit, y + 4.5 * unit])
        flat = np.c_[flat * 6 * unit + centre, np.zeros(len(flat))].astype(np.float32)
        batch_for_shader(shader, "TRIS", {"pos": flat, "color": colours}).draw(shader)
        _write(text, left + pad + 22 * unit, y, unit)


def _write(text: str, x: float, y: float, unit: float) -> None:
    blf.size(0, 12.0 * unit)
    blf.color(0, 0.92, 0.92, 0.92, 1.0)
    blf.position(0, x, y, 0.0)
    blf.draw(0, text)
