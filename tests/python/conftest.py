# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender first: its oneTBB must be loaded before the native module's, and its USD must be the only one."""

import contextlib

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401

import pytest


@pytest.fixture
def ending(monkeypatch):
    """The core's jobs that closing a generator has cancelled, as they were added to those that nobody waits for: each
    with the fraction that was done of it then."""

    class Ending(list):
        def append(self, job):
            cancelled.append((job, job.fraction))
            super().append(job)

    cancelled = []
    monkeypatch.setattr("stormfield.work._ending", Ending())
    return cancelled


@pytest.fixture(params=["netCDF4", "without netCDF4"])
def reader(request, monkeypatch):
    """Blender has no netCDF4: all that is read with it is read without it too."""
    from grid_cases import without_netcdf4

    if request.param != "netCDF4":
        without_netcdf4(monkeypatch)
