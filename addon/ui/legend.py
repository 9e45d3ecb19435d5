# SPDX-License-Identifier: GPL-3.0-or-later
"""The legend: a box in the lower right corner of the view, with one block for each thing that is drawn."""

from dataclasses import dataclass, field

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from . import markers

LINE, PAD, WIDTH = 19.0, 10.0, 168.0


@dataclass
class Block:
    title: str
    rows: list[tuple[str, str]] = field(default_factory=list)  #: kind and text
    ramp: np.ndarray | None = None  #: (k, 4) colours from λ = 0 to 1

    @property
    def lines(self) -> int:
        return 1 + len(self.rows) + (self.ramp is not None)


def draw(context: bpy.types.Context, blocks: list[Block]) -> None:
    unit = context.preferences.system.ui_scale
    gap = 0.45 * LINE
    height = (LINE * sum(block.lines for block in blocks) + gap * (len(blocks) - 1) + 2 * PAD - 5) * unit
    width = WIDTH * unit
    sidebar = next((r.width for r in context.area.regions if r.type == "UI" and r.width > 1), 0)
    overlap = context.preferences.system.use_region_overlap
    left = context.region.width - (sidebar if overlap else 0) - width - 14 * unit
    bottom = 14 * unit
    gpu.state.blend_set("ALPHA")
    corners = [(left, bottom), (left + width, bottom), (left + width, bottom + height), (left, bottom + height)]
    _fill([corners[i] for i in (0, 1, 2, 0, 2, 3)], [(0.08, 0.08, 0.09, 0.72)] * 6)
    left += PAD * unit
    y = bottom + height - (PAD + 11) * unit
    for block in blocks:
        _write(block.title, left, y, unit, 1.0)
        for kind, text in block.rows:
            y -= LINE * unit
            flat, colours = markers.triangles(kind)
            _fill(flat * 6 * unit + (left + 7 * unit, y + 4.5 * unit), colours)
            _write(text, left + 22 * unit, y, unit, 0.92)
        if block.ramp is not None:
            y -= LINE * unit
            _ramp(block.ramp, left, y, unit)
        y -= (LINE + gap) * unit


def _ramp(colours: np.ndarray, left: float, y: float, unit: float) -> None:
    _write("λ 0", left, y, unit, 0.92)
    _write("1", left + (WIDTH - 2 * PAD - 8) * unit, y, unit, 0.92)
    edges = np.linspace(left + 30 * unit, left + (WIDTH - 2 * PAD - 16) * unit, len(colours))
    corners, tints = [], []
    for i in range(len(colours) - 1):
        box = [(edges[i + a], y + b * unit) for a, b in ((0, 0), (1, 0), (1, 9), (0, 9))]
        corners += [box[k] for k in (0, 1, 2, 0, 2, 3)]
        tints += [colours[i + k] for k in (0, 1, 1, 0, 1, 0)]
    _fill(corners, tints)


def _fill(corners, colours) -> None:
    shader = compat.builtin_shader("SMOOTH_COLOR")
    flat = np.asarray(corners, np.float32).reshape(-1, 2)
    positions = np.c_[flat, np.zeros(len(flat), np.float32)]
    batch_for_shader(
        shader, "TRIS", {"pos": positions.astype(np.float32), "color": np.asarray(colours, np.float32)}
    ).draw(shader)


def _write(text: str, x: float, y: float, unit: float, light: float) -> None:
    blf.size(0, 12.0 * unit)
    blf.color(0, light, light, light, 1.0)
    blf.position(0, x, y, 0.0)
    blf.draw(0, text)
