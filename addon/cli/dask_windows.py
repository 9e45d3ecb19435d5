# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of a tracking on Dask: processes of this machine, or the workers of a scheduler that is there already.

What was read of FIELD goes to each worker once: its mesh, and of a grid where its samples are, so that each worker
reads those of its own windows and the file must have the same name on all machines. A worker that dies costs its
windows, which Dask gives to others; the result is the same.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from itertools import pairwise
from typing import Any

import numpy as np

from .. import native
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.words import Json
from ..readers import FieldData
from ..readers.field_data import Samples
from ..work import Step, Steps

#: A window that has failed so often ends the command.
ATTEMPTS = 3
#: Seconds in which a scheduler, and the first of its workers, must answer.
ANSWER = 10
#: The libraries that read grids do not serve two threads of a worker at once.
READING = threading.Lock()


def follow_window(
    mesh: MeshData, samples: Samples, lambdas: np.ndarray, first: int, last: int, threads: int | None
) -> Json:
    """The part of samples `first` to `last`, both in it: what a worker does, on so many threads; None is as many as
    Dask gave it."""
    from ..analysis.windows import window_part

    native.load_alone()
    with native.ThreadLimit(threads or _threads_of_worker()):
        surface = _surface(mesh)
        with READING:
            own = samples[first : last + 1]
            tangents = np.stack([native.VectorField.from_space(surface, sample).values for sample in own])
        within = np.asarray(lambdas[first : last + 1], np.float64)
        followed = native.tracking(native.ParameterizedField(surface, within, tangents))
        return window_part(followed, surface, within, tangents)


@lru_cache(maxsize=1)
def _surface(mesh: MeshData) -> native.TriangleMesh:
    """Made once in each worker, which has the mesh once."""
    return native.TriangleMesh(mesh.vertices, mesh.triangles)


def _threads_of_worker() -> int:
    from distributed import get_worker

    return int(get_worker().state.nthreads)


def windows_of(samples: int, count: int) -> list[tuple[int, int]]:
    """`count` windows of nearly equal length that share one sample, fewer where there are not so many."""
    cuts = np.unique(np.round(np.linspace(0, samples - 1, count + 1)).astype(int))
    return list(pairwise(cuts.tolist()))


def follow(
    data: FieldData, windows: list[tuple[int, int]], scheduler: str | None, at_once: int | None = None
) -> Steps[list[tuple[str, Json]]]:
    """The parts by name. at_once: how many windows the memory of this machine holds, where it is to follow them; None
    is as many as it has processors. Raises InputError where Dask is missing or does not answer."""
    processors = os.cpu_count() or 1
    workers = min(len(windows), processors, at_once or len(windows))
    threads = max(processors // workers, 1) if scheduler is None else None
    with _client(scheduler, workers) as client:
        from distributed import as_completed

        # On all workers, so that one that dies takes nothing along.
        sent = [client.scatter(item, broadcast=True, hash=False) for item in (data.mesh, data.vectors)]
        waiting = {
            client.submit(follow_window, *sent, data.lambdas, first, last, threads, pure=False, retries=ATTEMPTS): (
                first,
                last,
            )
            for first, last in windows
        }
        parts = []
        for future in as_completed(waiting):
            first, last = waiting[future]
            parts.append((f"samples {first} to {last}", future.result()))
            yield Step(len(parts) / len(windows), "following windows")
    return parts


def has_dask() -> bool:
    return find_spec("distributed") is not None


@contextmanager
def _client(scheduler: str | None, workers: int) -> Iterator[Any]:
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError(f"Dask is needed, but cannot be loaded ({error}): pip install distributed") from error
    if scheduler is None:
        # Dask's own limit is a share of the machine for each processor, however few workers there are.
        options: Any = {"n_workers": workers, "threads_per_worker": 1, "memory_limit": 0, "dashboard_address": None}
        with LocalCluster(**options) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(scheduler, timeout=ANSWER)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: does not answer ({error}); start it, or leave it out") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=ANSWER)
        except TimeoutError as error:
            raise InputError(
                f"--scheduler {scheduler}: has no workers; start some with: dask worker ADDRESS"
            ) from error
        yield client
