# SPDX-License-Identifier: GPL-3.0-or-later
"""How many samples are followed at once: as many as memory holds. The rest is followed in windows, one after another.

count = windows_that_fit(samples=744, vertices=761_762, limit=4e9, name="wind.nc")      # 15
"""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

from ..model.errors import InputError

#: Bytes that one vector of one sample needs while it is followed: measured 56 to 63, and room for its paths.
BYTES = 80
#: The share of free memory that samples may take; results and what else the machine does have the other part.
SHARE = 0.5
GB = 1e9


def limit_of(memory: float | None) -> float:
    """Bytes that samples may take: of --memory, in GB, else of what is free."""
    return SHARE * free_memory() if memory is None else memory * GB


def size_of(samples: int, vertices: int) -> float:
    """Bytes of samples that are followed at once."""
    return float(BYTES) * samples * vertices


def windows_that_fit(samples: int, vertices: int, limit: float, name: str) -> int:
    """The least number of windows, which share a sample, each of at most `limit` bytes. Raises InputError where not
    even the two samples of the shortest fit."""
    if size_of(samples, vertices) <= limit:
        return 1
    at_once = int(limit / size_of(1, vertices))
    if at_once < 2:
        raise InputError(
            f"{name}: two samples of {vertices} vertices need {shown(size_of(2, vertices))} of memory, and "
            f"{shown(limit)} may be used; give --memory, a coarser mesh or --sphere-faces"
        )
    return math.ceil((samples - 1) / (at_once - 1))


def shown(size: float) -> str:
    """Bytes in words."""
    return f"{size / GB:.3g} GB"


def free_memory() -> float:
    """Bytes that this process could still get, infinite where the system does not tell."""
    return min(_of_system(), _of_group())


def _of_system() -> float:
    if sys.platform == "win32":
        return _of_windows()
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration, ValueError):
        pass
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        return math.inf


def _of_group() -> float:
    """What the control group of a job or container leaves, on Linux."""
    try:
        folder = (
            Path("/sys/fs/cgroup") / Path("/proc/self/cgroup").read_text(encoding="ascii").split("::/", 1)[1].strip()
        )
        limit, used = ((folder / f"memory.{word}").read_text(encoding="ascii").strip() for word in ("max", "current"))
        return math.inf if limit == "max" else max(float(limit) - float(used), 0.0)
    except (OSError, IndexError, ValueError):
        return math.inf


def _of_windows() -> float:
    if sys.platform != "win32":
        return math.inf
    import ctypes

    class Status(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ulong), ("load", ctypes.c_ulong)] + [
            (name, ctypes.c_ulonglong)
            for name in ("total", "free", "total_page", "free_page", "total_virtual", "free_virtual", "extended")
        ]

    status = Status(length=ctypes.sizeof(Status))
    return float(status.free) if ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)) else math.inf
