# SPDX-License-Identifier: GPL-3.0-or-later
"""Evenly spaced streamlines (thesis 3.4) as polylines with what hair and curve shading needs. No Blender here.

drawing = run(streamline_steps(mesh, values, Settings(density=0.02)))
drawing.curves[i], drawing.radii[i], drawing.attributes["speed"][i]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.mesh_data import MeshData
from ..work import Step, Steps, result_of
from .seeds import normals_at
from .steps import READ_ONE, check_moves, field_steps

#: Distance between two arrow heads on a line, in distances between lines; length and half width of a head, in radii of
#: lines.
ARROW_EVERY, ARROW_LENGTH, ARROW_WIDTH = 14.0, 6.5, 4.0
#: Heads are drawn where a line has at least this fraction of its full width.
ARROW_TAPER = 0.4


@dataclass(frozen=True)
class Settings:
    density: float = 0.02  #: distance between lines over the object's size, the square root of its area
    width: float = 0.25  #: of a line over the distance between lines
    taper: float = 1.0  #: how much lines narrow at ends and next to others, 0..1
    arrows: bool = False  #: heads that point with the flow
    topology: bool = True  #: periodic orbits and separatrices first


@dataclass(frozen=True, eq=False)
class StreamlineDrawing:
    """Curves in object space, lifted off the surface by the radius; arrow heads, of three points each, come last."""

    curves: list[np.ndarray]  #: (k, 3) each; closed ones do not repeat their first point
    radii: list[np.ndarray]  #: (k,) each, mesh units
    closed: np.ndarray  #: (n,) bool
    attributes: dict[str, list[np.ndarray]]  #: per point: speed (mesh units per second), distance (along the line)
    curve_attributes: dict[str, np.ndarray]  #: per curve: length, role (see native roles), arrow
    lines: int  #: curves that are lines, not arrow heads
    quiet_area: float  #: fraction of the surface where the field is zero, 0..1
    gaps: int  #: places that could not be reached


def streamline_steps(mesh: MeshData, values: np.ndarray, settings: Settings) -> Steps[StreamlineDrawing]:
    """values: (n, 3) at the vertices. Raises InputError for a field of zeros and settings without meaning."""
    surface, field = yield from field_steps(mesh, values)
    check_moves(values, "there is nothing to draw")
    distance = settings.density * surface.size
    job = native.start_evenly_spaced_streamlines(field, distance, topology=settings.topology)
    lines = yield from result_of(job, READ_ONE, "Placing streamlines")
    yield Step(1.0, "Making curves", waiting=True)
    return drawing_of(lines, surface, distance, settings)


def drawing_of(
    lines: native.EvenStreamlines, surface: native.TriangleMesh, distance: float, settings: Settings
) -> StreamlineDrawing:
    """lines: native EvenStreamlines on `surface`, a native TriangleMesh. distance: between lines, mesh units."""
    radius = 0.5 * settings.width * distance
    normals = normals_at(surface, lines.faces, lines.barycentric)
    points = lines.points + radius * normals
    width = 1.0 - settings.taper * (1.0 - lines.taper)
    cuts = lines.offsets[1:-1]

    def split(per_point: np.ndarray) -> list[np.ndarray]:
        return np.split(per_point, cuts) if len(lines) else []

    curves, radii = split(points), split(radius * width)
    attributes = {"speed": split(lines.speed), "distance": split(lines.arc)}
    lengths = [arc[-1] for arc in attributes["distance"]]
    roles = list(lines.roles)
    if settings.arrows:
        at, ahead = _heads(lines, ARROW_EVERY * distance)
        along = lines.points[ahead] - lines.points[at]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        back, aside = ARROW_LENGTH * radius * along, ARROW_WIDTH * radius * np.cross(normals[at], along)
        barbs = np.stack([points[at] - back + aside, points[at], points[at] - back - aside], axis=1)
        owner = np.searchsorted(lines.offsets, at, side="right") - 1
        for i, barb, line in zip(at, barbs, owner, strict=True):
            curves.append(barb)
            radii.append(radius * np.array([0.4, 1.0, 0.4]))
            attributes["speed"].append(np.full(3, lines.speed[i]))
            attributes["distance"].append(np.full(3, lines.arc[i]))
            lengths.append(lengths[line])
            roles.append(roles[line])
    heads = len(curves) - len(lines)
    return StreamlineDrawing(
        curves,
        radii,
        np.concatenate([lines.closed, np.zeros(heads, bool)]),
        attributes,
        {
            "length": np.array(lengths, np.float64),
            "role": np.array(roles, np.int32),
            "arrow": np.arange(len(curves)) >= len(lines),
        },
        len(lines),
        lines.quiet_area,
        len(lines.gaps),
    )


def _heads(lines: native.EvenStreamlines, every: float) -> tuple[np.ndarray, np.ndarray]:
    """The points that carry a head, evenly along each line and at least one on long ones, and the points after them."""
    chosen = []
    for begin, end in zip(lines.offsets[:-1], lines.offsets[1:], strict=True):
        arc = lines.arc[begin:end]
        count = max(int(arc[-1] / every + 0.5), int(arc[-1] > 0.4 * every))
        chosen.append(begin + np.searchsorted(arc, (np.arange(count) + 0.5) / max(count, 1) * arc[-1]))
    at = np.unique(np.concatenate(chosen)).astype(np.int64) if chosen else np.zeros(0, np.int64)
    at = at[lines.taper[at] >= ARROW_TAPER]
    last = np.isin(at, lines.offsets[1:] - 1)
    return at[~last], at[~last] + 1
