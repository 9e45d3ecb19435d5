# SPDX-License-Identifier: GPL-3.0-or-later
"""Tracking in windows as ratios (make bench): eight windows over one piece, and on two workers over one.

python -m pytest -s tests/benchmarks/bench_windows.py (settings in tests/benchmarks/pytest.ini)

A worker is a process with one processor, as Dask counts them. Starting the cluster is not measured.
"""

import statistics
import time

import numpy as np
import pytest
from data_sets import data_set
from stormfield import native
from stormfield.analysis.stitching import joined
from stormfield.analysis.windows import window_part
from stormfield.cli.dask_windows import follow, windows_of
from stormfield.readers import Choice, read_series
from stormfield.work import run

FACES, WINDOWS, ROUNDS = 500_000, 8, 3


def seconds(work):
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


@pytest.fixture(scope="module")
def wind():
    native.load_alone()
    return read_series(data_set("gfs_wind_michael_2018.npz"), Choice(sphere_faces=FACES))


def followed(wind, mesh, first, last):
    part = slice(first, last + 1)
    tangents = np.stack([native.VectorField.from_space(mesh, sample).values for sample in wind.vectors[part]])
    lambdas = np.asarray(wind.lambdas[part], np.float64)
    return native.tracking(native.ParameterizedField(mesh, lambdas, tangents)), lambdas, tangents


def bench_windows_one_after_another_over_one_piece(wind):
    mesh = native.TriangleMesh(wind.mesh.vertices, wind.mesh.triangles)
    cuts = windows_of(len(wind.lambdas), WINDOWS)

    def in_windows():
        parts = []
        for first, last in cuts:
            found, lambdas, tangents = followed(wind, mesh, first, last)
            parts.append((str(first), window_part(found, mesh, lambdas, tangents)))
        joined(parts)

    whole = [seconds(lambda: followed(wind, mesh, 0, len(wind.lambdas) - 1)) for _ in range(ROUNDS)]
    windows = [seconds(in_windows) for _ in range(ROUNDS)]
    ratio = statistics.median(windows) / statistics.median(whole)
    print(f"\n{WINDOWS} windows over one piece: {ratio:.2f} ({min(windows):.1f} s, {min(whole):.1f} s)")


def bench_two_workers_over_one(wind):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install distributed")
    cuts, spent = windows_of(len(wind.lambdas), WINDOWS), {}
    for workers in (1, 2):
        options = {"n_workers": workers, "threads_per_worker": 1, "memory_limit": 0, "dashboard_address": None}
        with distributed.LocalCluster(**options) as cluster:
            address = cluster.scheduler_address
            spent[workers] = [seconds(lambda: run(follow(wind, cuts, address))) for _ in range(ROUNDS)]  # noqa: B023
    ratio = statistics.median(spent[1]) / statistics.median(spent[2])
    print(f"\n{WINDOWS} windows on two workers: {ratio:.2f} times as fast as on one ({spent[1]} s, {spent[2]} s)")
