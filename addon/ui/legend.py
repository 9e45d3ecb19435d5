# SPDX-License-Identifier: GPL-3.0-or-later
"""The legend: a box in the lower right corner of the view, with one block for each thing that is drawn.

A click folds it. It never covers more than MOST of the view.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import compat
from . import markers, palette

LINE, PAD, WIDTH, GAP = 19.0, 10.0, 168.0, 8.5
#: Most of the view that it covers.
MOST = 0.1
#: Legends that are kept on the GPU.
KEPT = 8


@dataclass(frozen=True)
class Block:
    title: str
    rows: tuple[tuple[str, str], ...] = ()  #: kind and text
    ramp: tuple[tuple[float, ...], ...] | None = None  #: (k, 4) colours from λ = 0 to 1

    @property
    def lines(self) -> int:
        return 1 + len(self.rows) + (self.ramp is not None)


@dataclass(frozen=True)
class Box:
    """Where the legend is, in pixels of the region."""

    left: float
    bottom: float
    width: float
    height: float

    def holds(self, x: float, y: float) -> bool:
        return 0.0 <= x - self.left <= self.width and 0.0 <= y - self.bottom <= self.height


_drawn: dict[int, Box] = {}  #: by region


def box_in(region: bpy.types.Region) -> Box | None:
    """The legend that was last drawn there."""
    return _drawn.get(region.as_pointer())


def forget() -> None:
    _drawn.clear()
    _picture.cache_clear()


def layout(blocks: list[Block], region_size: tuple[float, float], unit: float, folded: bool) -> tuple[list[Block], Box]:
    """The blocks that fit, and the size of their box (its place is 0): all of them; else without rows; else the first
    line alone; nothing where even that would cover more than MOST of the view."""
    titles = [Block(block.title) for block in blocks]
    for shown in [titles[:1]] if folded else [blocks, titles, titles[:1]]:
        height = (LINE * sum(block.lines for block in shown) + GAP * (len(shown) - 1) + 2 * PAD - 5) * unit
        if WIDTH * unit * height <= MOST * region_size[0] * region_size[1]:
            return shown, Box(0.0, 0.0, WIDTH * unit, height)
    return [], Box(0.0, 0.0, 0.0, 0.0)


def draw(context: bpy.types.Context, blocks: list[Block], folded: bool) -> None:
    unit, region = context.preferences.system.ui_scale, context.region
    shown, size = layout(blocks, (region.width, region.height), unit, folded)
    _drawn.pop(region.as_pointer(), None)
    if not shown:
        return
    sidebar = next((r.width for r in context.area.regions if r.type == "UI" and r.width > 1), 0)
    overlap = context.preferences.system.use_region_overlap
    left = region.width - (sidebar if overlap else 0) - size.width - 14 * unit
    box = Box(left, 14 * unit, size.width, size.height)
    _drawn[region.as_pointer()] = box
    shapes = tuple((tuple(kind for kind, _ in block.rows), block.ramp) for block in shown)
    picture = _picture(box, shapes, unit, folded or len(shown) < len(blocks), palette.name())
    gpu.state.blend_set("ALPHA")
    picture.fills.draw(compat.builtin_shader("SMOOTH_COLOR"))
    blf.size(0, 12.0 * unit)
    for text, (x, y, light) in zip((text for block in shown for text in _texts(block)), picture.places, strict=True):
        blf.color(0, light, light, light, 1.0)
        blf.position(0, x, y, 0.0)
        blf.draw(0, text)


def _texts(block: Block) -> Iterator[str]:
    """The words of a block, in the order of their places."""
    yield block.title
    yield from (text for _, text in block.rows)
    if block.ramp is not None:
        yield from ("λ 0", "1")


@dataclass(frozen=True)
class _Picture:
    """What a legend is drawn from, whatever its words: one batch of coloured triangles, and where the words stand."""

    fills: object
    places: list[tuple[float, float, float]]  #: x and y in pixels, lightness 0..1


@lru_cache(maxsize=KEPT)
def _picture(box: Box, shapes: tuple, unit: float, folded: bool, _palette: str) -> _Picture:
    """The blocks inside their box. shapes: per block the kinds of its rows, and its ramp."""
    right, top = box.left + box.width, box.bottom + box.height
    corners = [(box.left, box.bottom), (right, box.bottom), (right, top), (box.left, top)]
    fills = [(np.array([corners[i] for i in (0, 1, 2, 0, 2, 3)]), np.array([(0.08, 0.08, 0.09, 0.72)] * 6))]
    places = []
    left = box.left + PAD * unit
    y = top - (PAD + 11) * unit
    fills.append(_fold_sign(right - (PAD + 6) * unit, y + 4.5 * unit, unit, folded))
    for kinds, ramp in shapes:
        places.append((left, y, 1.0))
        for kind in kinds:
            y -= LINE * unit
            flat, colours = markers.triangles(kind)
            fills.append((flat * 6 * unit + (left + 7 * unit, y + 4.5 * unit), colours))
            places.append((left + 22 * unit, y, 0.92))
        if ramp is not None:
            y -= LINE * unit
            fills.append(_ramp(np.array(ramp), left, y, unit))
            places += [(left, y, 0.92), (left + (WIDTH - 2 * PAD - 8) * unit, y, 0.92)]
        y -= LINE * unit + GAP * unit
    flat, colours = (np.concatenate(parts) for parts in zip(*fills, strict=True))
    content = {"pos": np.c_[flat, np.zeros(len(flat))].astype(np.float32), "color": colours.astype(np.float32)}
    return _Picture(batch_for_shader(compat.builtin_shader("SMOOTH_COLOR"), "TRIS", content), places)


def _fold_sign(x: float, y: float, unit: float, folded: bool) -> tuple[np.ndarray, np.ndarray]:
    """A triangle as in Blender's panels: to the left while folded, downwards while open."""
    shape = np.array([(3.0, 4.0), (3.0, -4.0), (-4.0, 0.0)] if folded else [(-4.0, 3.0), (4.0, 3.0), (0.0, -4.0)])
    return shape * unit + (x, y), np.array([(0.85, 0.85, 0.85, 1.0)] * 3)


def _ramp(colours: np.ndarray, left: float, y: float, unit: float) -> tuple[np.ndarray, np.ndarray]:
    edges = np.linspace(left + 30 * unit, left + (WIDTH - 2 * PAD - 16) * unit, len(colours))
    corners, tints = [], []
    for i in range(len(colours) - 1):
        box = [(edges[i + a], y + b * unit) for a, b in ((0, 0), (1, 0), (1, 9), (0, 9))]
        corners += [box[k] for k in (0, 1, 2, 0, 2, 3)]
        tints += [colours[i + k] for k in (0, 1, 1, 0, 1, 0)]
    return np.array(corners), np.array(tints)
