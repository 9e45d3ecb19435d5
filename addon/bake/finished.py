# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished caches that belong to a design and a bake, whoever made them.

Names of caches follow from what they are made from, so those that a farm has baked are found by looking for them.
"""

from dataclasses import dataclass, field
from pathlib import Path

from ..cache.field_cache import open_cache
from ..cache.layout import MANIFEST
from ..model.design import Design
from ..model.errors import InputError
from .job import origin_of
from .lambda_cache import lambda_plan
from .targets import TARGETS
from .task import BakeTask, TargetName


@dataclass(frozen=True)
class Finished:
    """Folders of finished caches."""

    solved: Path | None = None  #: the λ cache
    targets: dict[TargetName, Path] = field(default_factory=dict)


def finished(task: BakeTask, design: Design) -> Finished:
    """What there is of a design's λ cache, solved from zero, and of the targets of a task that is baked from it."""
    folder = task.root / lambda_plan(task.mesh, design).folder_name("lambda")
    if not (folder / MANIFEST).is_file():
        return Finished()
    lambdas, origin = open_cache(folder).lambdas, origin_of(task, folder)
    found: dict[TargetName, Path] = {}
    for name in TARGETS:
        if name in task.targets and _can_be_baked(task, name):
            place = task.root / TARGETS[name].plan(task, lambdas, origin).folder_name(TARGETS[name].name)
            if (place / MANIFEST).is_file():
                found[name] = place
    return Finished(folder, found)


def _can_be_baked(task: BakeTask, name: TargetName) -> bool:
    """Whether the task has all that a target needs, such as a UV layer: else nobody has baked it."""
    try:
        TARGETS[name].check(task)
    except InputError:
        return False
    return True
