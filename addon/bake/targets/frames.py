# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture coordinates that flow, per frame: what the materials read as sf_phase_a, sf_phase_b, sf_blend
(docs/architecture.md, decision 12).

Each phase is the place, in object space, where the material at a vertex was when its cycle began, carried along the
advection field with λ as keyframed; the core explains the cycles (native/texture/advected_coordinates.h). Shaders blend
a solid texture T with mean m, taken at both phases, without losing contrast:

    m + ((1 - blend) (T(a) - m) + blend (T(b) - m)) / sqrt((1 - blend)² + blend²)

Each frame is computed from the task alone, not from its neighbours: any split gives the same bytes. Before its
first frame λ is taken to be constant.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

import numpy as np

from ... import native
from ...cache import fields
from ...cache.field_cache import FieldCache, FrameCacheWriter
from ...cache.plan import MeshIdentity, Plan
from ...work import Step, Steps, result_of
from ..task import BakeTask
from .target import Origin

PHASE_A, PHASE_B, BLEND = "sf_phase_a", "sf_phase_b", "sf_blend"


class FlowingTexture:
    """A frame cache for the Mesh Sequence Cache modifier."""

    name: ClassVar[str] = "frames"

    def __init__(self, task: BakeTask, cache: FieldCache, origin: Origin) -> None:
        self._task, self._cache = task, cache
        plan = self.plan(task, cache.lambdas, origin)
        self.folder: Path = task.root / plan.folder_name(self.name)
        self._writer = FrameCacheWriter(
            self.folder, task.mesh, task.frames, plan.settings, polygons=task.polygons, resume=task.resume, replace=True
        )

    @classmethod
    def plan(cls, task: BakeTask, lambdas: np.ndarray, origin: Origin) -> Plan:
        settings = {"flow": vars(task.flow), "from": origin}
        return Plan("usd", "frame", task.frames, MeshIdentity.of(task.mesh), settings)

    @staticmethod
    def check(task: BakeTask) -> None:
        """Any frames can be baked."""

    def samples(self, indices: set[int]) -> Iterable[int]:
        return indices

    def missing(self, among: Iterable[int]) -> list[int]:
        return self._writer.missing(among)

    def write(self, samples: list[int]) -> Steps[list[str]]:
        yield Step(0.0, "Reading the field")
        surface = fields.solved_surface(self._cache, self._task.mesh)
        mesh = fields.native_mesh(surface.mesh)
        coordinates = FlowCoordinates(fields.parameterized(self._cache, fields.ADVECTION, mesh, surface), self._task)
        for done, index in enumerate(samples):
            message = f"Carrying texture to frame {self._task.frames[index]}"
            start, end = done / len(samples), (done + 1) / len(samples)
            found = yield from result_of(coordinates.start(index), start, message, end)
            attributes = coordinates.attributes_of(found)
            self._writer.write_sample(index, {name: surface.to_mesh(values) for name, values in attributes.items()})
        return []

    def absent(self) -> list[str]:
        return self._writer.absent()

    def finish(self) -> Steps[bool]:
        return self._writer.finish(verify=self._task.verify)


class FlowCoordinates:
    """The coordinates at the frames of a task, on its advection field."""

    def __init__(self, field: native.ParameterizedField, task: BakeTask) -> None:
        self.frames = tuple(task.frames)
        self._coordinates = native.AdvectedCoordinates(
            field,
            np.asarray(task.frames, np.float64),
            np.asarray(task.lambdas, np.float64),
            frames_per_second=float(task.frames_per_second),
            period=float(task.flow.period),
            speed=float(task.flow.speed),
        )

    def start(self, index: int) -> native.AdvectionJob:
        """Begins the task's frame of that index on other threads: a job for attributes_of(job.result())."""
        return self._coordinates.start_frames([self.frames[index]])

    @staticmethod
    def attributes_of(found: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> dict[str, np.ndarray]:
        """The attributes of one frame, float32, (n, 3) and (n,)."""
        ((phase_a, phase_b, blend),) = found
        return {PHASE_A: phase_a, PHASE_B: phase_b, BLEND: blend}

    def error(self, index: int) -> dict[str, float]:
        """Error of the carried coordinates against much finer traces, in mean edge lengths."""
        return self._coordinates.error(self.frames[index])
