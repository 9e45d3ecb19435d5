# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves as the command line leaves: bpy 4.5 can wait for ever in its static destructors."""

import sys

import pytest

STATUS = pytest.StashKey[int]()


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    if "bpy" in sys.modules and STATUS in config.stash:
        from stormfield.cli.blender import leave

        leave(config.stash[STATUS])
