# SPDX-License-Identifier: GPL-3.0-or-later
"""The one long job at a time, as the panels see it. Never saved with the file, so nothing needs repair on load."""

from dataclasses import dataclass

import bpy

from . import objects


@dataclass
class RunningJob:
    title: str  #: "Solving", "Baking"
    object_uid: int | None  #: None for work that makes a new object
    name_at_begin: str
    fraction: float = 0.0  #: 0..1
    message: str = ""
    cancel_requested: bool = False

    def object(self) -> bpy.types.Object | None:
        """What the job works for; None when it was deleted meanwhile, or is still to be made."""
        return None if self.object_uid is None else objects.find(self.object_uid)

    @property
    def has_lost_object(self) -> bool:
        """Whether what it works for was deleted meanwhile."""
        return self.object_uid is not None and self.object() is None

    @property
    def object_name(self) -> str:
        obj = self.object()
        return self.name_at_begin if obj is None else obj.name


_current: RunningJob | None = None


def current() -> RunningJob | None:
    return _current


def begin(title: str, obj: bpy.types.Object | None, name: str = "") -> RunningJob:
    """name: what work without an object is called."""
    global _current
    _current = RunningJob(title, None, name) if obj is None else RunningJob(title, obj.session_uid, obj.name)
    return _current


def end() -> None:
    global _current
    _current = None


def request_cancel() -> None:
    if _current is not None:
        _current.cancel_requested = True
