"""The one long job at a time, as the panels see it. Never saved with the file, so nothing needs repair on load."""

from dataclasses import dataclass


@dataclass
class RunningJob:
    title: str  #: "Solving", "Baking"
    object_name: str
    fraction: float = 0.0  #: 0..1
    message: str = ""
    cancel_requested: bool = False


_current: RunningJob | None = None


def current() -> RunningJob | None:
    return _current


def begin(title: str, object_name: str) -> RunningJob:
    global _current
    _current = RunningJob(title, object_name)
    return _current


def end() -> None:
    global _current
    _current = None


def request_cancel() -> None:
    if _current is not None:
        _current.cancel_requested = True
