# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of a tracking on Dask: processes of this machine, or the workers of a scheduler that is there already.

Each worker reads its own window, so FIELD must have the same name on all machines. A worker that dies costs its
windows, which Dask gives to others; the result is the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
    vectors = [data.vectors[j] for j in range(first, last + 1)]
    tangents = np.stack([native.VectorField.from_space(mesh, sample).values for sample in vectors])
    lambdas = np.asarray(data.lambdas[first : last + 1], np.float64)
    return window_json(native.tracking(native.ParameterizedField(mesh, lambdas, tangents)), mesh, lambdas, tangents)


def windows_of(samples: int, count: int) -> list[tuple[int, int]]:
    """`count` windows of nearly equal length that share one sample, fewer where there are not so many."""
    cuts = np.unique(np.round(np.linspace(0, samples - 1, count + 1)).astype(int))
    return list(pairwise(cuts.tolist()))


def follow(
    field: str, choice: Choice, windows: list[tuple[int, int]], scheduler: str | None
) -> Steps[list[tuple[str, Json]]]:
    """The parts by name. Raises InputError where Dask is missing or does not answer."""
    with _client(scheduler) as client:
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


@contextmanager
def _client(scheduler: str | None) -> Iterator[Any]:
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError(f"--windows needs Dask, which cannot be loaded ({error}): pip install distributed") from error
    if scheduler is None:
        with LocalCluster(threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: does not answer ({error}); start it, or leave it out") from error
    with client:
        yield client
