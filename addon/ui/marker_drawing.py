# SPDX-License-Identifier: GPL-3.0-or-later
"""Markers in the 3D view: they face the viewer and keep their size on screen at any zoom; surfaces hide them."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from . import markers, palette

#: Radius of a marker on screen, in pixels at 100 % interface scale.
RADIUS = 7.0
#: Batches that are kept while view and markers stay.
KEPT = 24
_batches: dict = {}
_RING = np.linspace(0.0, 2.0 * np.pi, 33)


@dataclass(frozen=True)
class Marker:
    kind: str  #: a kind, or one of SHAPES around or over a marker
    position: np.ndarray  #: (3,) in the object's space
    size: float = 1.0  #: of RADIUS
    opacity: float = 1.0


def draw(context: bpy.types.Context, matrix_world, shown: Iterable[Marker]) -> None:
    """Draw markers of one object in view space; the caller has set blending and depth test."""
    marks = list(shown)
    if not marks:
        return
    view, region = context.region_data, context.region
    key = (
        np.array(matrix_world).tobytes(),
        np.array(view.perspective_matrix).tobytes(),
        (region.width, region.height, context.preferences.system.ui_scale, palette.name()),
        tuple((mark.kind, mark.size, mark.opacity, mark.position.tobytes()) for mark in marks),
    )
    if key not in _batches:
        if len(_batches) >= KEPT:
            _batches.clear()
        _batches[key] = _batch(context, np.array(matrix_world), marks)
    made = _batches[key]
    if made is not None:
        made.draw(compat.builtin_shader("SMOOTH_COLOR"))


def forget() -> None:
    _batches.clear()


def _batch(context: bpy.types.Context, matrix: np.ndarray, marks: list[Marker]):
    """The markers as they face this view; None where all are behind the viewer."""
    view = context.region_data
    perspective = np.array(view.perspective_matrix)
    axes = np.array(view.view_matrix.inverted())
    right, up, back = axes[:3, 0], axes[:3, 1], axes[:3, 2]
    eye = axes[:3, 3] if view.is_perspective else None
    pixels = RADIUS * context.preferences.system.ui_scale
    scale = np.linalg.norm(np.array(view.window_matrix)[1, :3]) * context.region.height / 2.0
    corners, colours = [], []
    for marker in marks:
        place = matrix[:3, :3] @ marker.position + matrix[:3, 3]
        depth = float(perspective[3, :3] @ place + perspective[3, 3])
        if depth <= 0:
            continue
        radius = pixels * depth / scale
        towards = back if eye is None else (eye - place) / np.linalg.norm(eye - place)
        flat, colour = SHAPES[marker.kind]() if marker.kind in SHAPES else markers.triangles(marker.kind)
        flat = flat * marker.size
        corners.append(place + radius * (flat[:, :1] * right + flat[:, 1:] * up) + 1.5 * radius * towards)
        colours.append(colour * (1.0, 1.0, 1.0, marker.opacity))
    if not corners:
        return None
    content = {"pos": np.concatenate(corners), "color": np.concatenate(colours)}
    return batch_for_shader(
        compat.builtin_shader("SMOOTH_COLOR"),
        "TRIS",
        {name: np.ascontiguousarray(values, np.float32) for name, values in content.items()},
    )


def ring() -> tuple[np.ndarray, np.ndarray]:
    """A white ring around a marker: corners (3 t, 2) and colours (3 t, 4)."""
    circle = np.stack([np.cos(_RING), np.sin(_RING)], axis=1)
    inner, outer = 1.45 * circle, 1.85 * circle
    corners = np.concatenate(
        [np.stack([inner[:-1], outer[:-1], outer[1:]], 1), np.stack([inner[:-1], outer[1:], inner[1:]], 1)]
    ).reshape(-1, 2)
    return corners.astype(np.float32), np.ones((len(corners), 4), np.float32)


def glow() -> tuple[np.ndarray, np.ndarray]:
    """A soft ring around what can be chosen."""
    return _annulus(1.3, 2.3, (1.0, 0.85, 0.3, 0.9), (1.0, 0.85, 0.3, 0.0))


def veil() -> tuple[np.ndarray, np.ndarray]:
    """A grey disc over what cannot be chosen."""
    return _annulus(0.0, 1.3, (0.32, 0.32, 0.34, 0.75), (0.32, 0.32, 0.34, 0.75))


def cross() -> tuple[np.ndarray, np.ndarray]:
    """Over what would vanish."""
    bar = np.array([(-1.5, -0.18), (1.5, -0.18), (1.5, 0.18), (-1.5, -0.18), (1.5, 0.18), (-1.5, 0.18)])
    turned = [bar @ np.array([(c, s), (-s, c)]) for c, s in ((0.7071, 0.7071), (0.7071, -0.7071))]
    corners = np.concatenate(turned).astype(np.float32)
    return corners, np.tile(np.array((0.95, 0.2, 0.15, 1.0), np.float32), (len(corners), 1))


def _annulus(inner: float, outer: float, first, last) -> tuple[np.ndarray, np.ndarray]:
    """From one radius and colour to the other."""
    circle = np.stack([np.cos(_RING), np.sin(_RING)], axis=1)
    near, far = inner * circle, outer * circle
    corners = np.concatenate(
        [np.stack([near[:-1], far[:-1], far[1:]], 1), np.stack([near[:-1], far[1:], near[1:]], 1)]
    ).reshape(-1, 2)
    count = len(_RING) - 1
    colours = np.concatenate(
        [np.tile((first, last, last), (count, 1, 1)), np.tile((first, last, first), (count, 1, 1))]
    )
    return corners.astype(np.float32), colours.reshape(-1, 4).astype(np.float32)


#: What may lie around or over a marker.
SHAPES = {"ring": ring, "glow": glow, "veil": veil, "cross": cross}


def on_screen(context: bpy.types.Context, matrix_world, positions: np.ndarray) -> np.ndarray:
    """(k, 2) pixels of the region; not a number behind the viewer."""
    matrix = np.array(context.region_data.perspective_matrix) @ np.array(matrix_world)
    clip = np.c_[positions, np.ones(len(positions))] @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = np.where(clip[:, 3:] > 0, clip[:, :2] / clip[:, 3:], np.nan)
    return 0.5 * (plane + 1.0) * np.array((context.region.width, context.region.height))
