"""Fixed points as discs that face the viewer: a colour and a shape per kind, the same size on screen at any zoom."""

import math

import numpy as np

#: kind -> (name in the legend, colour); the thesis's source green, sink red and saddle blue.
KINDS = {
    "source": ("Source", (0.10, 0.78, 0.24)),
    "sink": ("Sink", (0.93, 0.16, 0.14)),
    "saddle": ("Saddle", (0.16, 0.42, 1.00)),
    "center": ("Center", (1.00, 0.78, 0.10)),
    "degenerate": ("Degenerate", (0.75, 0.35, 0.95)),
}
Colour = tuple[float, float, float, float]
RIM: Colour = (0.02, 0.02, 0.03, 1.0)
LIGHT: Colour = (1.0, 1.0, 1.0, 1.0)


def _circle(radius: float, corners: int = 24) -> np.ndarray:
    angles = np.arange(corners) * (2 * math.pi / corners)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def shape(kind: str) -> list[tuple[np.ndarray, Colour]]:
    """Convex polygons (k, 2) with colours, painted in this order; a radius of 1 is the marker's own.

    Shapes differ too, for eyes that do not tell red from green: a source has a bright core, a sink is full, a saddle is
    a diamond, a center is a ring.
    """
    red, green, blue = KINDS.get(kind, KINDS["degenerate"])[1]
    colour = (red, green, blue, 1.0)
    if kind == "saddle":
        return [(_circle(1.30, 4), RIM), (_circle(1.10, 4), colour)]
    layers = [(_circle(1.0), RIM), (_circle(0.82), colour)]
    if kind == "source":
        layers.append((_circle(0.34), LIGHT))
    elif kind == "center":
        layers.append((_circle(0.46), RIM))
    return layers


def triangles(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """The shape as triangles: corners (3 t, 2) and their colours (3 t, 4)."""
    corners, colours = [], []
    for polygon, colour in shape(kind):
        count = len(polygon)
        fan = [(0, i, i + 1) for i in range(1, count - 1)]
        corners.append(polygon[np.array(fan).ravel()])
        colours.append(np.tile(colour, (3 * len(fan), 1)))
    return np.concatenate(corners).astype(np.float32), np.concatenate(colours).astype(np.float32)
