# SPDX-License-Identifier: GPL-3.0-or-later
"""What targets with one file for each frame share: the core makes the content, a library in Blender writes the file."""

from __future__ import annotations

import contextlib
from collections.abc import Generator, Iterable
from functools import partial
from pathlib import Path
from typing import ClassVar, Generic, TypeVar

import numpy as np

from ... import native
from ...cache import fields
from ...cache.field_cache import FieldCache
from ...cache.plan import MeshIdentity, Plan
from ...cache.store import CacheStore
from ...model.words import Json
from ...work import Job, Step, Steps, between, result_of, scaled, with_message
from ..task import BakeTask
from .target import Origin

#: Where a file is made and its writing begins, in the fractions of its steps.
MADE = 0.5

#: What the core makes once for all frames, and what of one frame is written.
Shared = TypeVar("Shared")
Content = TypeVar("Content")


class FrameFiles(Generic[Shared, Content]):
    """One file for each frame of the task, named frames/frame_0001.* so that Blender finds the sequence."""

    #: Target in the plan; begins the folder's name in the task's root, as a key of the plan ends it.
    name: ClassVar[str] = ""
    preparing = ""  #: message of the work that all frames share
    making = ""  #: message of one frame's work

    def __init__(self, task: BakeTask, cache: FieldCache, origin: Origin) -> None:
        self._task, self._cache = task, cache
        plan = self.plan(task, cache.lambdas, origin)
        self._identity = plan.mesh
        self._store = CacheStore(task.root / plan.folder_name(self.name), plan, resume=task.resume)

    @classmethod
    def plan(cls, task: BakeTask, lambdas: np.ndarray, origin: Origin) -> Plan:
        content = {cls.name: cls._settings(task), "from": origin}
        return Plan(cls.name, "frame", tuple(int(frame) for frame in task.frames), MeshIdentity.of(task.mesh), content)

    @property
    def folder(self) -> Path:
        return self._store.folder

    def samples(self, indices: set[int]) -> Iterable[int]:
        return indices

    def missing(self, among: Iterable[int]) -> list[int]:
        return self._store.missing(among)

    def absent(self) -> list[str]:
        return self._store.absent()

    def finish(self) -> Steps[bool]:
        return with_message(self._store.finish(verify=self._task.verify), "Finishing the files")

    def write(self, samples: list[int]) -> Steps[list[str]]:
        yield Step(0.0, self.preparing)
        self._surface = fields.solved_surface(self._cache, self._task.mesh)
        mesh = fields.native_mesh(self._surface.mesh)
        # What all frames share counts as one frame more.
        frames = len(samples) + 1
        shared = yield from result_of(self._start_shared(mesh), 0.0, self.preparing, 1.0 / frames)
        for done, index in enumerate(samples, start=1):
            yield from self._write_file(index, shared, mesh, done / frames, (done + 1) / frames)
        return self._remarks(shared)

    def _write_file(
        self, index: int, shared: Shared, mesh: native.TriangleMesh, start: float, end: float
    ) -> Steps[None]:
        lam, made = self._task.lambdas[index], between(start, end, MADE)
        message = f"{self.making} of frame {self._task.frames[index]}"
        yield Step(start, message)
        sample = fields.on_surface(self._cache.at(lam), self._surface)
        content = yield from scaled(self._make(shared, sample, mesh, message), start, made)
        write = partial(self._write, shared, content, lam)
        with contextlib.closing(self._store.write_in_steps(index, write)) as fractions:
            for fraction in fractions:
                yield Step(between(made, end, fraction), message)

    # Of each target ---------------------------------------------------------------------------------------------------

    @classmethod
    def _settings(cls, task: BakeTask) -> dict[str, Json]:
        """JSON of all that decides the files, besides mesh, frames and origin. Raises InputError for useless ones."""
        raise NotImplementedError

    def _start_shared(self, mesh: native.TriangleMesh) -> Job[Shared]:
        """Begins what all frames share: a job."""
        raise NotImplementedError

    def _make(
        self, shared: Shared, sample: dict[str, np.ndarray], mesh: native.TriangleMesh, message: str
    ) -> Steps[Content]:
        """The content of one file, for _write. sample: the attributes of the λ cache at λ."""
        raise NotImplementedError

    def _write(self, shared: Shared, content: Content, lam: float, path: Path) -> Generator[float]:
        """Leaves a complete file at path; yields the fraction that is written. Raises OSError."""
        raise NotImplementedError

    def _remarks(self, shared: Shared) -> list[str]:
        """What the artist should know; empty when all is well."""
        return []
