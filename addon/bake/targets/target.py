# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake asks of a target: one folder of samples that can be written in any order, on many machines.

target = FlowMaps(task, cache, origin)
missing = target.missing(target.samples(task.indices()))
remarks = run(target.write(missing))
run(target.finish())                               # False while samples of other machines are missing
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import ClassVar, Protocol

import numpy as np

from ...cache.field_cache import FieldCache
from ...cache.plan import Plan
from ...model.words import Json
from ...work import Steps
from ..task import BakeTask

#: JSON of what the samples are made from: part of the plan of every target.
Origin = Mapping[str, Json]


class Target(Protocol):
    name: ClassVar[str]  #: word of the folder in the task's root: task.root / plan.folder_name(name)

    def __init__(self, task: BakeTask, cache: FieldCache, origin: Origin) -> None:
        """Opens the folder: keeps what is finished where the task resumes, and deletes what was baked otherwise."""

    @classmethod
    def plan(cls, task: BakeTask, lambdas: np.ndarray, origin: Origin) -> Plan:
        """The plan of these files; lambdas: of the samples of the λ cache. Equal plans have equal folders."""

    @property
    def folder(self) -> Path: ...

    @staticmethod
    def check(task: BakeTask) -> None:
        """Raises InputError on what can be seen without the λ cache."""

    def samples(self, indices: set[int]) -> Iterable[int]:
        """The samples that a machine writes to which these places in task.frames belong."""

    def missing(self, among: Iterable[int]) -> list[int]:
        """Those of them that are not finished, in order. Reads the finished ones, to check them."""

    def write(self, samples: list[int]) -> Steps[list[str]]:
        """Writes these samples, at least one; returns remarks for the artist. Closing the steps leaves no torn file."""

    def absent(self) -> list[str]:
        """Names of the samples that no machine has finished yet."""

    def finish(self) -> Steps[bool]:
        """Writes what joins the samples, then the manifest. False while samples are missing."""
