# SPDX-License-Identifier: GPL-3.0-or-later
"""Which samples of a cache are still to write."""

from collections.abc import Iterable
from typing import Protocol

from ..work import Step, Steps

#: Finished files that are read and checked between two steps.
CHECK_BATCH = 8


class Resumable(Protocol):
    def missing(self, among: Iterable[int]) -> list[int]: ...


def unfinished(writer: Resumable, samples: Iterable[int]) -> Steps[list[int]]:
    """The samples that the writer has to write, in order. Checks batches, so that the window stays responsive."""
    ordered = sorted(samples)
    missing: list[int] = []
    for start in range(0, len(ordered), CHECK_BATCH):
        yield Step(0.0, "Looking for what is finished")
        missing += writer.missing(ordered[start : start + CHECK_BATCH])
    return missing
