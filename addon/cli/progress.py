"""Progress on standard error: a bar in a terminal, a line now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: Seconds between two lines where there is no terminal.
QUIET = 5.0


@contextmanager
def progress(title: str) -> Iterator[Any]:
    """Yields show(step) for steps of bake.job."""
    if sys.stderr.isatty():
        with _bar(title) as show:
            yield show
    else:
        yield _Lines(title)


@contextmanager
def _bar(title: str) -> Iterator[Any]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, TextColumn("{task.fields[message]}"), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=1.0, message="")

        def show(step) -> None:
            bar.update(task, completed=step.fraction, message=step.message)
            for note in step.notes:
                bar.console.print(f"note: {note}", markup=False)

        yield show


class _Lines:
    def __init__(self, title: str):
        self._title = title
        self._said = time.monotonic()

    def __call__(self, step) -> None:
        for note in step.notes:
            print(f"note: {note}", file=sys.stderr)
        if time.monotonic() - self._said >= QUIET:
            self._said = time.monotonic()
            print(f"{self._title}: {step.fraction:.0%} {step.message}", file=sys.stderr, flush=True)
