# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixed points as discs that face the viewer: a colour and a shape per kind, the same size on screen at any zoom."""

import math
from functools import cache

import numpy as np

from . import palette

#: kind -> its name in legends.
NAMES = {
    "storm": "Storm",
    "source": "Source",
    "sink": "Sink",
    "saddle": "Saddle",
    "center": "Center",
    "degenerate": "Degenerate",
    "repelling": "Repelling orbit",
    "attracting": "Attracting orbit",
    "trivial": "Trivial",
    "other": "Other",
    "creation": "Appear",
    "annihilation": "Vanish",
    "hopf": "Change",
}
#: Colours of events over λ, which no entity has.
EVENTS = {
    "creation": (1.00, 0.86, 0.35),
    "annihilation": (0.95, 0.45, 0.80),
    "hopf": (0.35, 0.85, 0.90),
}
#: Of the place where the paths of elements meet.
MEETING = (1.0, 1.0, 1.0)
Colour = tuple[float, float, float, float]
RIM: Colour = (0.02, 0.02, 0.03, 1.0)
LIGHT: Colour = (1.0, 1.0, 1.0, 1.0)


def colour_of(kind: str) -> tuple[float, float, float]:
    if kind == "meeting":
        return MEETING
    return EVENTS.get(kind) or palette.kind_colour("center" if kind == "storm" else kind)


def _circle(radius: float, corners: int = 24, turned: float = 0.0) -> np.ndarray:
    angles = turned + np.arange(corners) * (2 * math.pi / corners)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


#: Corners and turn of the outlines that are no discs.
OUTLINES = {
    "saddle": (4, 0.0),
    "trivial": (4, 0.25 * math.pi),
    "degenerate": (6, 0.0),
    "other": (5, 0.5 * math.pi),
    "creation": (3, 0.5 * math.pi),
    "annihilation": (3, -0.5 * math.pi),
    "hopf": (8, math.pi / 8),
    "meeting": (4, 0.0),
}


def shape(kind: str) -> list[tuple[np.ndarray, Colour]]:
    """Convex polygons (k, 2) with colours, painted in this order; a radius of 1 is the marker's own.

    Shapes differ too, for eyes that see no difference between red and green: a source has a bright core, a sink is
    full, a saddle is a diamond, a center is a ring; orbits are wide rings, with a bright core where they repel.
    """
    colour = (*colour_of(kind), 1.0)
    if kind in OUTLINES:
        corners, turned = OUTLINES[kind]
        size = 1.30 if corners < 5 else 1.05
        return [(_circle(size, corners, turned), RIM), (_circle(size - 0.20, corners, turned), colour)]
    layers = [(_circle(1.0), RIM), (_circle(0.82), colour)]
    if kind == "storm":  # two arms, as on weather maps
        arms = [turn * np.array([(0.62, 0.30), (1.22, 1.02), (-0.10, 0.95)]) for turn in (1.0, -1.0)]
        layers = [*((arm, RIM) for arm in arms), *layers, *((0.82 * arm, colour) for arm in arms)]
    if kind == "source":
        layers.append((_circle(0.34), LIGHT))
    elif kind in {"center", "storm"}:
        layers.append((_circle(0.46), RIM))
    elif kind in {"repelling", "attracting"}:
        layers += [(_circle(0.58), RIM), (_circle(0.40), LIGHT if kind == "repelling" else colour)]
    return layers


def triangles(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """The shape as triangles: corners (3 t, 2) and their colours (3 t, 4)."""
    return _triangles(kind, palette.name())


@cache
def _triangles(kind: str, _palette: str) -> tuple[np.ndarray, np.ndarray]:
    corners, colours = [], []
    for polygon, colour in shape(kind):
        count = len(polygon)
        fan = [(0, i, i + 1) for i in range(1, count - 1)]
        corners.append(polygon[np.array(fan).ravel()])
        colours.append(np.tile(colour, (3 * len(fan), 1)))
    return np.concatenate(corners).astype(np.float32), np.concatenate(colours).astype(np.float32)
