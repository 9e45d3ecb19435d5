# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes by which elements are known: arrows of travel, ticks of λ, a ring for the radius, a sign for the turning.

Everything here is flat or a plain polyline; element_drawing.py lays it onto the surface.
"""

import numpy as np

_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 65)


def ring() -> list[np.ndarray]:
    """The unit circle, as polylines (k, 2)."""
    return [np.stack([np.cos(_CIRCLE), np.sin(_CIRCLE)], axis=1)]


def sign(kind: str, angle: float = 0.0) -> list[np.ndarray]:
    """What the flow does around a fixed point of that kind, inside the unit circle: polylines (k, 2) with arrow heads.

    Counter-clockwise is as seen from outside. angle: of a saddle's outgoing axis (radians).
    """
    if kind == "saddle":
        return _saddle(angle)
    if kind in {"source", "sink"}:
        rays = []
        for turn in np.arange(4) * 0.5 * np.pi + 0.25 * np.pi:
            ends = np.outer((0.25, 0.8), (np.cos(turn), np.sin(turn)))
            rays += _with_head(ends if kind == "source" else ends[::-1])
        return rays
    turning = -1.0 if kind.endswith("_cw") else 1.0
    radii = {"spiral_in": (0.85, 0.35), "spiral_out": (0.35, 0.85)}.get(kind.rpartition("_")[0], (0.62, 0.62))
    arcs = []
    for begin in np.arange(3) * 2.0 * np.pi / 3.0:
        along = begin + turning * np.linspace(0.0, 1.5, 9)
        radius = np.linspace(*radii, 9)
        arcs += _with_head(np.stack([radius * np.cos(along), radius * np.sin(along)], axis=1))
    return arcs


def event_sign(kind: str, angle: float = 0.0) -> list[np.ndarray]:
    """What a bifurcation does, along the axis at `angle`: the node ahead and the saddle behind, that come apart or
    together; or the orbit that is born or dies."""
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    grows = kind.startswith("appear") or kind == "hopf_birth"
    if kind.startswith("hopf"):
        lines = [0.5 * line for line in ring()]
        ends = [np.array([[0.2, 0.0], [0.45, 0.0]]), np.array([[-0.2, 0.0], [-0.45, 0.0]])]
    else:
        lines = [0.12 * line + (0.5, 0.0) for line in ring()]
        lines += [np.array([[-0.6, -0.1], [-0.4, 0.1]]), np.array([[-0.6, 0.1], [-0.4, -0.1]])]
        ends = [np.array([[0.08, 0.0], [0.36, 0.0]]), np.array([[-0.08, 0.0], [-0.38, 0.0]])]
    for end in ends:
        lines += _with_head(end if grows else end[::-1], 0.12)
    return [line @ turn for line in lines]


def _saddle(angle: float) -> list[np.ndarray]:
    """Out along the axis at `angle`, in along the other."""
    lines = []
    for turn, inward in ((angle, False), (angle + np.pi, False), (angle + np.pi / 2, True), (angle - np.pi / 2, True)):
        ends = np.outer((0.15, 0.8), (np.cos(turn), np.sin(turn)))
        lines += _with_head(ends[::-1] if inward else ends)
    return lines


def _with_head(line: np.ndarray, size: float = 0.22) -> list[np.ndarray]:
    back = line[-2] - line[-1]
    back = back / max(float(np.linalg.norm(back)), 1e-12)
    aside = np.array([-back[1], back[0]])
    head = [line[-1] + size * (back + side * 0.7 * aside) for side in (1.0, -1.0)]
    return [line, np.stack([head[0], line[-1], head[1]])]


def resampled(line: np.ndarray, step: float, values: np.ndarray | None = None):
    """The polyline with points every `step` or less, corners kept; with `values`, those too at the new points."""
    pieces = np.maximum(1, np.ceil(np.linalg.norm(np.diff(line, axis=0), axis=1) / step).astype(int))
    at = np.concatenate([i + np.arange(n) / n for i, n in enumerate(pieces)] + [np.array([len(line) - 1.0])])
    known = np.arange(len(line))
    points = np.stack([np.interp(at, known, line[:, axis]) for axis in range(line.shape[1])], axis=1)
    return points if values is None else (points, np.interp(at, known, values))


def spread(line: np.ndarray, count: int) -> np.ndarray:
    """The polyline with so many points, as far from each other."""
    arc = arc_length(line)
    at = np.linspace(0.0, arc[-1], count)
    return np.stack([np.interp(at, arc, line[:, axis]) for axis in range(line.shape[1])], axis=1)


def smoothed(line: np.ndarray, times: int) -> np.ndarray:
    """Each point moved half-way to the middle of its neighbours; the ends of an open line stay."""
    closed = bool(np.allclose(line[0], line[-1])) and len(line) > 3
    for _ in range(times):
        middle = 0.25 * line[:-2] + 0.5 * line[1:-1] + 0.25 * line[2:]
        join = 0.25 * line[-2:-1] + 0.5 * line[:1] + 0.25 * line[1:2]
        line = np.concatenate([join, middle, join] if closed else [line[:1], middle, line[-1:]])
    return line


def arc_length(line: np.ndarray) -> np.ndarray:
    """(k,) from the first point."""
    return np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]


def chevrons(line: np.ndarray, normals: np.ndarray, every: float, size: float) -> list[np.ndarray]:
    """Arrow heads along a line, at least one: polylines (3, 3). A single point has none."""
    if len(line) < 2:
        return []
    arc = arc_length(line)
    count = max(1, round(arc[-1] / every))
    heads = []
    for place in (np.arange(count) + 0.5) / count * arc[-1]:
        i = int(np.clip(np.searchsorted(arc, place) - 1, 0, len(line) - 2))
        along = line[i + 1] - line[i]
        length = float(np.linalg.norm(along))
        if length == 0.0:
            continue
        along = along / length
        tip = line[i] + (place - arc[i]) * along
        aside = np.cross(normals[i], along)
        heads.append(np.stack([tip - size * (along + 0.6 * aside), tip, tip - size * (along - 0.6 * aside)]))
    return heads


def ticks(line: np.ndarray, normals: np.ndarray, lam: np.ndarray, half: float) -> list[np.ndarray]:
    """Strokes across a path at every tenth of λ, or every half where these would stand too close: polylines (2, 3)."""
    if len(line) < 2:
        return []
    marks = []
    for time in _even_times(lam[0], lam[-1], arc_length(line)[-1] / (2.5 * half)):
        i = int(np.clip(np.searchsorted(lam, time) - 1, 0, len(line) - 2))
        share = (time - lam[i]) / (lam[i + 1] - lam[i]) if lam[i + 1] > lam[i] else 0.0
        place = line[i] + np.clip(share, 0.0, 1.0) * (line[i + 1] - line[i])
        aside = np.cross(normals[i], line[i + 1] - line[i])
        aside = aside / max(float(np.linalg.norm(aside)), 1e-12)
        marks.append(np.stack([place - half * aside, place + half * aside]))
    return marks


def _even_times(first: float, last: float, most: float) -> np.ndarray:
    """The tenths or halves of λ from first to last, at most so many; none where even these are more."""
    for step in (0.1, 0.5):
        times = np.arange(np.ceil(first / step - 1e-6), np.floor(last / step + 1e-6) + 1) * step
        if len(times) <= most + 1:
            return times
    return np.zeros(0)


def side_arrows(line: np.ndarray, normals: np.ndarray, every: float, size: float, inward: bool) -> list[np.ndarray]:
    """Arrow heads on both sides of a line, that point to it or away from it: polylines (3, 3). A
    single point has none."""
    if len(line) < 2:
        return []
    arc = arc_length(line)
    count = max(1, round(arc[-1] / every))
    heads = []
    for place in np.arange(count) / count * arc[-1]:
        i = int(np.clip(np.searchsorted(arc, place, side="right") - 1, 0, len(line) - 2))
        along = line[i + 1] - line[i]
        along = along / max(float(np.linalg.norm(along)), 1e-12)
        aside = np.cross(normals[i], along)
        foot = line[i] + (place - arc[i]) * along
        for side in (1.0, -1.0):
            near, far = foot + side * size * aside, foot + side * 1.8 * size * aside
            tip, back = (near, far) if inward else (far, near)
            heads.append(np.stack([back - 0.5 * size * along, tip, back + 0.5 * size * along]))
    return heads
