# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: λ cache → everything that a task asks for, target by target.

    check_task(task)                                   # before a long solve, not after it
    result = run(bake_steps(task))                     # BakeResult

Closing the steps stops running work, removes the unfinished file and keeps finished ones, so that the same call
continues from there.
"""

from dataclasses import replace
from pathlib import Path

from ..cache.checksums import sha256
from ..cache.field_cache import open_cache
from ..cache.layout import MANIFEST
from ..model.design import Design
from ..model.errors import InputError
from ..model.words import Json
from ..version import VERSION
from ..work import Steps, between, scaled
from .lambda_cache import is_warm_started, solve_steps
from .targets import TARGETS, Target
from .task import BakeResult, BakeTask, TargetName
from .unfinished import unfinished

#: Fraction of a bake that solving from zero takes, where it has to.
RESOLVE_SHARE = 0.3
#: Fraction of a target after which its samples are written and are joined.
WRITTEN = 0.9


def check_task(task: BakeTask) -> None:
    """Raises InputError on what can be seen without the λ cache."""
    unknown = task.targets - TARGETS.keys()
    if unknown:
        raise InputError(f"unknown target '{min(unknown)}'; choose from {', '.join(TARGETS)}")
    task.indices()
    for name in task.targets:
        TARGETS[name].check(task)


def bake_steps(task: BakeTask) -> Steps[BakeResult]:
    """Writes the targets of a task, one after the other. A warm-started λ cache is solved from zero first."""
    check_task(task)
    begin = 0.0
    if is_warm_started(task.cache):
        begin = RESOLVE_SHARE
        task = yield from scaled(_solve_from_zero(task), 0.0, begin)
    cache = open_cache(task.cache)
    cache.check_mesh(task.mesh)
    origin = origin_of(task, cache.folder)
    folders: dict[TargetName, Path] = {}
    remarks: list[str] = []
    absent: list[str] = []
    names = [name for name in TARGETS if name in task.targets]
    for number, name in enumerate(names):
        target = TARGETS[name](task, cache, origin)
        start, join, end = (between(begin, 1.0, (number + part) / len(names)) for part in (0.0, WRITTEN, 1.0))
        remarks += yield from scaled(_write_missing(target, task), start, join)
        whole = yield from scaled(target.finish(), join, end)
        if not whole:
            absent += [f"{name}/{sample}" for sample in target.absent()]
        folders[name] = target.folder
    return BakeResult(folders, tuple(remarks), tuple(absent), task.cache)


def origin_of(task: BakeTask, field: Path) -> dict[str, Json]:
    """What the files of a task are made from, besides its settings; field: folder of the finished λ cache."""
    return {
        "field": sha256(field / MANIFEST),
        "lambdas": [float(lam) for lam in task.lambdas],
        "frames_per_second": float(task.frames_per_second),
        "stormfield": VERSION,
    }


def _solve_from_zero(task: BakeTask) -> Steps[BakeTask]:
    """The task with its λ cache solved from zero: a bake gives the same bytes whatever was edited before it."""
    cache = open_cache(task.cache)
    cache.check_mesh(task.mesh)
    design = Design.from_json(cache.settings["design"])
    folder = yield from solve_steps(task.mesh, design, task.cache.parent, task.polygons)
    return replace(task, cache=folder)


def _write_missing(target: Target, task: BakeTask) -> Steps[list[str]]:
    missing = yield from unfinished(target, target.samples(task.indices()))
    return (yield from target.write(missing)) if missing else []
