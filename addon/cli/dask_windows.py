# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of a tracking on Dask: processes of this machine, or the workers of a scheduler that is there already.

Each worker reads its own window, so FIELD must have the same name on all machines. A worker that dies costs its
windows, which Dask gives to others; the result is the same.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import pairwise
from typing import Any

import numpy as np

from ..model.errors import InputError
from ..model.words import Json
from ..readers import Choice, read_series
from ..work import Step, Steps

#: A window that has failed so often ends the command.
ATTEMPTS = 3


def follow_window(field: str, choice: Choice, first: int, last: int) -> Json:
    """The part of samples `first` to `last`, both in it: what a worker does."""
    from .. import native
    from ..analysis.windows import window_json
    from .output import surface_of

    native.load_alone()
    data = read_series(field, choice)
    mesh = surface_of(data.mesh, field)
    vectors = (data.vectors[j] for j in range(first, last + 1))
    tangents = np.stack([native.VectorField.from_space(mesh, sample).values for sample in vectors])
    lambdas = np.asarray(data.lambdas[first : last + 1], np.float64)
    return window_json(native.tracking(native.ParameterizedField(mesh, lambdas, tangents)), mesh, lambdas, tangents)


def windows_of(samples: int, count: int) -> list[tuple[int, int]]:
    """`count` windows of nearly equal length that share one sample, fewer where there are not so many."""
    cuts = np.unique(np.round(np.linspace(0, samples - 1, count + 1)).astype(int))
    return list(pairwise(cuts.tolist()))


def follow(
    field: str, choice: Choice, windows: list[tuple[int, int]], scheduler: str | None, at_once: int | None = None
) -> Steps[list[tuple[str, Json]]]:
    """The parts by name. at_once: how many windows the memory of this machine holds, where it is to follow them; None
    is as many as it has processors. Raises InputError where Dask is missing or does not answer."""
    workers = min(len(windows), os.cpu_count() or 1, at_once or len(windows))
    with _client(scheduler, workers) as client:
        from distributed import as_completed

        waiting = {
            client.submit(follow_window, field, choice, first, last, pure=False, retries=ATTEMPTS): (first, last)
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
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: does not answer ({error}); start it, or leave it out") from error
    with client:
        yield client
