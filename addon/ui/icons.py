# SPDX-License-Identifier: GPL-3.0-or-later
"""The marker of every kind as an icon for lists and nodes, painted from the same shapes as the overlay's."""

import bpy
import bpy.utils.previews
import numpy as np

from . import markers, palette

SIZE = 32
#: Each pixel is this many points in each direction, for smooth rims.
FINE = 3
_icons = None


def of(kind: str) -> int:
    """The icon's number for `icon_value`; 0, no icon, in background mode."""
    global _icons
    if bpy.app.background:
        return 0
    if _icons is None:
        _icons = bpy.utils.previews.new()
    key = f"{palette.name()} {kind}"
    if key not in _icons:
        icon = _icons.new(key)
        icon.icon_size = icon.image_size = (SIZE, SIZE)  # type: ignore[assignment]
        pixels = paint(kind)
        icon.icon_pixels_float = icon.image_pixels_float = pixels.ravel().tolist()  # type: ignore[assignment]
    return _icons[key].icon_id


def paint(kind: str) -> np.ndarray:
    """(SIZE, SIZE, 4) from the bottom up, transparent around the marker."""
    axis = (np.arange(SIZE * FINE) + 0.5) / (SIZE * FINE) * 2.8 - 1.4
    x, y = np.meshgrid(axis, axis)
    pixels = np.zeros((SIZE * FINE, SIZE * FINE, 4))
    for polygon, colour in markers.shape(kind):
        inside = np.ones_like(x, bool)
        for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            inside &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0
        pixels[inside] = colour
    return pixels.reshape(SIZE, FINE, SIZE, FINE, 4).mean(axis=(1, 3))


def unregister() -> None:
    global _icons
    if _icons is not None:
        bpy.utils.previews.remove(_icons)
        _icons = None
