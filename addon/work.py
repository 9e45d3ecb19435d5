# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work as generators of steps: the modal operator runs slices of them, background mode and command line all.

    steps = solve_steps(mesh, design, root)               # any function that returns Steps
    for step in steps: show(step.fraction, step.message)  # step.waiting: the core works on its own threads, come back

    folder = run(steps)                                   # blocks, and returns what the generator returned

Closing a generator cancels its work at that step. Work that can end early with what is complete takes a Stop:
throw it into the generator, and continue for the result.
"""

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

#: Seconds that run() sleeps at a step of waiting work.
POLL = 0.02

Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


class Job(Protocol[Result_co]):
    """Work on the core's threads, as every start_... function of the core returns it."""

    @property
    def fraction(self) -> float:
        """Fraction of the work that is done, 0..1."""

    @property
    def done(self) -> bool:
        """Whether the work has ended, by itself or not."""

    def cancel(self) -> None:
        """Asks the work to stop; it does within 0.1 s."""

    def result(self) -> Result_co:
        """Waits; raises what the work raised."""


@dataclass(frozen=True)
class Step:
    fraction: float  #: of the whole, 0..1
    message: str
    waiting: bool = False  #: nothing to do here for some hundredths of a second
    notes: tuple[str, ...] = ()  #: what the artist should know although nothing is wrong


Steps = Generator[Step, None, Result]


class Stop(Exception):  # noqa: N818  a request, no error
    """Thrown into steps that can end early: end soon, with what is complete."""


def run(steps: Steps[Result], show: Callable[[Step], None] = lambda step: None) -> Result:
    """Runs a generator to its end."""
    try:
        while True:
            step = next(steps)
            show(step)
            if step.waiting:
                time.sleep(POLL)
    except StopIteration as end:
        return end.value
    finally:
        steps.close()


def between(start: float, end: float, fraction: float) -> float:
    """The number at that fraction of the way from start to end."""
    return start + (end - start) * fraction


def scaled(steps: Steps[Result], start: float, end: float) -> Steps[Result]:
    """The same steps as the range start..end of a longer work."""
    try:
        while True:
            step = next(steps)
            yield replace(step, fraction=between(start, end, step.fraction))
    except StopIteration as stop:
        return stop.value
    finally:
        steps.close()


def with_message(fractions: Generator[float, None, Result], message: str) -> Steps[Result]:
    """Steps of work that only yields the fraction that is done."""
    try:
        while True:
            yield Step(next(fractions), message)
    except StopIteration as stop:
        return stop.value
    finally:
        fractions.close()


#: Jobs that were cancelled and have not ended yet: dropping one would wait for it.
_ending: list[Job[object]] = []


def result_of(job: Job[Result], start: float, message: str, end: float = 1.0) -> Steps[Result]:
    """Waits for a job on the core's threads and returns its result. start, end: its range in the steps' fractions.

    Closing the generator cancels the job and does not wait until it has ended. After Stop the result is what the job
    has completed, or native.Cancelled where it leaves nothing.
    """
    try:
        while not job.done:
            try:
                yield Step(between(start, end, job.fraction), message, waiting=True)
            except Stop:
                job.cancel()
        return job.result()
    finally:
        abandon(job)


def abandon(job: Job[Result]) -> None:
    """Cancels a job that nobody waits for any more, and does not wait until it has ended."""
    _ending[:] = [ending for ending in _ending if not ending.done]
    if not job.done:
        job.cancel()
        _ending.append(job)
