# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on standard error: a bar in a terminal; elsewhere lines now and then, which farms of Open Job
Description show as the task's progress, and others in its log."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext

from ..work import Step

#: Seconds between two lines where there is no terminal.
QUIET = 5.0


@contextmanager
def progress(title: str) -> Iterator[Callable[[Step], None]]:
    """Yields show(step) for steps (work.py). An interrupt stops the work at its next step."""
    with _interrupts() as stop_if_asked, _bar(title) if sys.stderr.isatty() else nullcontext(_Lines(title)) as show:

        def show_or_stop(step: Step) -> None:
            stop_if_asked()
            show(step)

        yield show_or_stop
        stop_if_asked()


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """Keeps an interrupt until the next step of the work: raised at once it can be lost inside a callback of USD. A
    second one is raised at once. Only the main thread gets interrupts."""
    if threading.current_thread() is not threading.main_thread():
        yield lambda: None
        return
    asked = threading.Event()
    earlier = signal.getsignal(signal.SIGINT) or signal.SIG_DFL

    def ask(number: int, frame: object) -> None:
        asked.set()
        signal.signal(signal.SIGINT, earlier)

    def stop_if_asked() -> None:
        if asked.is_set():
            raise KeyboardInterrupt

    signal.signal(signal.SIGINT, ask)
    try:
        yield stop_if_asked
    finally:
        signal.signal(signal.SIGINT, earlier)


@contextmanager
def _bar(title: str) -> Iterator[Callable[[Step], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, TextColumn("{task.fields[message]}"), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=1.0, message="")

        def show(step: Step) -> None:
            bar.update(task, completed=step.fraction, message=step.message)
            for note in step.notes:
                bar.console.print(f"note: {note}", markup=False)

        yield show


class _Lines:
    def __init__(self, title: str):
        self._title = title
        self._printed = time.monotonic()

    def __call__(self, step: Step) -> None:
        for note in step.notes:
            print(f"note: {note}", file=sys.stderr)
        if time.monotonic() - self._printed >= QUIET:
            self._printed = time.monotonic()
            print(f"openjd_progress: {100.0 * step.fraction:.1f}", file=sys.stderr)
            print(f"openjd_status: {self._title}: {step.fraction:.0%} {step.message}", file=sys.stderr, flush=True)
