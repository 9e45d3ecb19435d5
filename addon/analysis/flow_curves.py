# SPDX-License-Identifier: GPL-3.0-or-later
"""Streamlines, pathlines, streaklines and timelines (thesis 10.1.2) over the frames of a scene. No Blender here.

    drawing = run(flow_curve_steps(mesh, lambdas, values, seeds_of, settings))
    drawing.curves[i], drawing.attributes["time"][i]

Streamlines and pathlines grow: their points carry the time at which the particle is there. Streaklines and timelines
change their shape: there is one set of curves for each frame.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .. import native
from ..cache.fields import native_mesh
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..work import Step, Steps, result_of
from .seeds import Seeds, normals_at, rings
from .steps import check_moves

#: Kinds whose points carry times, and kinds with curves for each frame.
GROWING, BY_FRAME = ("STREAMLINE", "PATHLINE"), ("STREAKLINE", "TIMELINE")
#: Where reading the field ends, and where tracing does, in the fractions of the steps.
READ, TRACED = 0.2, 0.9


@dataclass(frozen=True)
class Settings:
    kind: str  #: STREAMLINE, PATHLINE, STREAKLINE, TIMELINE
    frames: Sequence[int]  #: increasing, at least two; particles are released at the first
    lambdas: Sequence[float]  #: λ at each frame
    frames_per_second: float
    speed: float = 1.0  #: factor on the field
    lam: float = 0.0  #: of streamlines
    spacing: float = 0.01  #: of the particles of streaklines and timelines, in object sizes
    ring: float = 0.05  #: radius of the rings that timelines begin as, in object sizes
    radius: float = 0.003  #: of the curves, in object sizes


@dataclass(frozen=True, eq=False)
class FlowCurves:
    """Curves in object space, lifted off the surface by their radius."""

    curves: list[np.ndarray]  #: (k, 3) each
    #: per point: speed (mesh units per second), lam, time (seconds of the scene), age (seconds since release)
    attributes: dict[str, list[np.ndarray]]
    curve_attributes: dict[str, np.ndarray]  #: per curve: seed (its number); by frame: frame
    radius: float  #: mesh units


def flow_curve_steps(
    mesh: MeshData,
    lambdas: Sequence[float],
    read_sample: Callable[[int], np.ndarray],
    seeds_of: Callable[[native.TriangleMesh], Seeds],
    settings: Settings,
) -> Steps[FlowCurves]:
    """read_sample(j): (n, 3) at the vertices for lambdas[j]; seeds_of(surface): the seeds, on the native mesh."""
    surface = native_mesh(mesh)
    vectors = np.empty((len(lambdas), len(mesh.vertices), 3))
    for j in range(len(lambdas)):
        yield Step(READ * j / len(lambdas), f"Reading sample {j + 1} of {len(lambdas)}")
        vectors[j] = read_sample(j)
    check_moves(vectors, "nothing moves")
    field = native.ParameterizedField(surface, np.asarray(lambdas, np.float64), surface.to_tangent(vectors))
    seeds = seeds_of(surface)
    if not len(seeds[0]):
        raise InputError("there are no points to start from; select vertices or raise the number of points")
    view = _PointAttributes(surface, np.asarray(lambdas, np.float64), vectors, settings)
    if settings.kind in GROWING:
        return (yield from _growing(view, field, seeds))
    return (yield from _by_frame(view, field, seeds))


class _PointAttributes:
    """What the points of curves carry."""

    def __init__(self, surface: native.TriangleMesh, lambdas: np.ndarray, vectors: np.ndarray, settings: Settings):
        self.surface, self.lambdas, self.vectors, self.settings = surface, lambdas, vectors, settings
        self.times = np.asarray(settings.frames, np.float64) / settings.frames_per_second
        self.track = np.asarray(settings.lambdas, np.float64)
        self.radius = settings.radius * surface.size

    def lifted(self, points: np.ndarray, faces: np.ndarray, barycentric: np.ndarray) -> np.ndarray:
        return points + self.radius * normals_at(self.surface, faces, barycentric)

    def lam_at(self, times: np.ndarray) -> np.ndarray:
        if self.settings.kind == "STREAMLINE":
            return np.full(len(times), self.settings.lam)
        return np.interp(times, self.times, self.track)

    def speed(self, faces: np.ndarray, barycentric: np.ndarray, lam: np.ndarray) -> np.ndarray:
        place = np.interp(lam, self.lambdas, np.arange(len(self.lambdas)))
        low = np.minimum(place.astype(np.int64), max(len(self.lambdas) - 2, 0))
        high, fraction = np.minimum(low + 1, len(self.lambdas) - 1), (place - low)[:, None]
        vertices = self.surface.triangles[faces]
        at = [(self.vectors[j[:, None], vertices] * barycentric[:, :, None]).sum(axis=1) for j in (low, high)]
        return abs(self.settings.speed) * np.linalg.norm((1.0 - fraction) * at[0] + fraction * at[1], axis=1)


def _growing(view: _PointAttributes, field: native.ParameterizedField, seeds: Seeds) -> Steps[FlowCurves]:
    settings, begin = view.settings, view.times[0]
    duration = view.times[-1] - begin
    track = (view.times, view.track)
    if settings.kind == "STREAMLINE":
        track = (np.array([begin]), np.array([settings.lam]))
    job = native.start_pathlines(field, *track, *seeds, begin, duration, speed=settings.speed)
    traces = yield from result_of(job, READ, "Following particles")
    yield Step(TRACED, "Making curves", waiting=True)
    times = begin + traces.times
    points = view.lifted(traces.points, traces.faces, traces.barycentric)
    lam = view.lam_at(times)
    speed = view.speed(traces.faces, traces.barycentric, lam)
    curves: list[np.ndarray] = []
    attributes: dict[str, list[np.ndarray]] = {"time": [], "lam": [], "speed": [], "age": []}
    for first, last in zip(traces.offsets[:-1], traces.offsets[1:], strict=True):
        line = slice(first, last)
        # A point at each frame: there, what has grown ends exactly where the particle is.
        between = view.times[(view.times > times[first]) & (view.times < times[last - 1])]
        at = np.union1d(times[line], between)
        curves.append(np.column_stack([np.interp(at, times[line], column) for column in points[line].T]))
        for name, values in (("time", times), ("lam", lam), ("speed", speed)):
            attributes[name].append(np.interp(at, times[line], values[line]))
        attributes["age"].append(at - begin)
    return FlowCurves(curves, attributes, {"seed": np.arange(len(curves), dtype=np.int32)}, view.radius)


def _by_frame(view: _PointAttributes, field: native.ParameterizedField, seeds: Seeds) -> Steps[FlowCurves]:
    settings, begin = view.settings, view.times[0]
    spacing = settings.spacing * view.surface.size
    common = (field, view.times, view.track)
    if settings.kind == "STREAKLINE":
        job = native.start_streaklines(*common, *seeds, begin, view.times, speed=settings.speed, spacing=spacing)
    else:
        start = rings(view.surface, seeds, settings.ring * view.surface.size)
        job = native.start_timelines(*common, start, begin, view.times, speed=settings.speed, spacing=spacing)
    sets = yield from result_of(job, READ, "Following particles")
    curves: list[np.ndarray] = []
    attributes: dict[str, list[np.ndarray]] = {"time": [], "lam": [], "speed": [], "age": []}
    owners: list[int] = []
    frames: list[int] = []
    for frame, lines in zip(settings.frames, sets, strict=True):
        yield Step(TRACED + (1.0 - TRACED) * len(set(frames)) / len(sets), "Making curves")
        faces, barycentric = lines.faces, lines.barycentric
        lam = view.lam_at(np.full(len(faces), lines.time))
        per_point = {
            "time": np.full(len(faces), lines.time),
            "lam": lam,
            "speed": view.speed(faces, barycentric, lam),
            "age": lines.ages,
        }
        points = view.lifted(lines.points, faces, barycentric)
        torn = np.flatnonzero(lines.torn) + 1
        ends = np.union1d(lines.offsets, torn)
        for first, last in itertools.pairwise(ends):
            if last - first < 2:
                continue
            curves.append(points[first:last])
            for name, values in per_point.items():
                attributes[name].append(values[first:last])
            owners.append(int(np.searchsorted(lines.offsets, first, side="right")) - 1)
            frames.append(frame)
    numbers = {"seed": np.array(owners, np.int32), "frame": np.array(frames, np.int32)}
    return FlowCurves(curves, attributes, numbers, view.radius)
