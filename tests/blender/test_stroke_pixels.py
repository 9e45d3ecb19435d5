# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay as pixels. Strokes stand out from every surface by 3 : 1, at rest and while they move."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


def drawn(benchmark, *arguments):
    """In a process of its own: drawing off-screen starts a graphics driver, which not every machine has."""
    command = [sys.executable, str(BENCHMARKS / benchmark), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if "draws only in a window" in done.stdout:
        pytest.skip("this Blender draws only in a window")
    if done.returncode != 0 and "GPU" in done.stderr:
        pytest.skip(f"no graphics driver: {done.stderr.splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout


def test_strokes_stand_out_from_every_surface():
    told = drawn("bench_contrast.py")
    rows = re.findall(r"^    (.+?) +(\d+\.\d+) +(\d+\.\d+)$", told.partition("contrast of strokes")[2], re.M)
    assert len(rows) == 8
    for surface, rest, moving in rows:
        assert float(rest) >= 3.0 and float(moving) >= 3.0, surface


def test_all_that_the_overlay_draws_is_drawn():
    """Field, strokes, elements, curves, markers, names and legend, through the handlers that a window calls."""
    pytest.importorskip("igraph", reason="graphs are laid out by igraph")
    assert re.search(r"^nothing changes +\d+\.\d+", drawn("bench_overlay.py", "--subdivisions", "4"), re.M)
