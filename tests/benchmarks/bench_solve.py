# SPDX-License-Identifier: GPL-3.0-or-later
"""From Solve to a cache that Blender can show, in parts: 41 000 vertices, 60 samples of λ, as an artist edits it.

python -m pytest -s tests/benchmarks/bench_solve.py (settings in tests/benchmarks/pytest.ini)

The second solve starts from the first, as in a window. "of this thread" is processor time of Python's thread: the rest
is the core's own threads, or waiting for them and for the disk.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from stormfield import native
from stormfield.bake.lambda_cache import solve_steps
from stormfield.cache import fields
from stormfield.model.design import Design
from stormfield.readers.icosphere import icosphere
from stormfield.solve import SolverState

FACES, SAMPLES = 81_920, 60


def vortex(name, x):
    return {
        "name": name, "type": "singular", "kind": "vortex_ccw", "lam": [0.0, 0.6], "radius": 0.1,
        "points": [[0.9, x, 0.2], [0.97, 0.0, 0.25]],
    }  # fmt: skip


def design(strength):
    jet = {"name": "Jet", "type": "streamline", "strength": strength, "points": [[1, 0, 0], [0.7, 0.7, 0], [0, 1, 0]]}
    content = {
        "schema": "stormfield.design/1",
        "settings": {"samples": SAMPLES},
        "elements": [vortex("West", -0.3), vortex("East", 0.3), jet],
    }
    return Design.from_json(content)


def parts(steps):
    """Seconds and processor seconds of this thread, by the message of the steps."""
    found = {}
    message, wall, own = "Reading the design", time.perf_counter(), time.thread_time()
    for step in steps:
        now, used = time.perf_counter(), time.thread_time()
        seconds, processor = found.get(message, (0.0, 0.0))
        found[message] = seconds + now - wall, processor + used - own
        message, wall, own = step.message, now, used
        if step.waiting:
            time.sleep(0.005)
    seconds, processor = found.get(message, (0.0, 0.0))
    found[message] = seconds + time.perf_counter() - wall, processor + time.thread_time() - own
    return found


def bench_solve_to_picture(tmp_path):
    mesh, state = icosphere(FACES), SolverState()
    for number, strength in enumerate((1.0, 1.1)):
        found = parts(solve_steps(mesh, design(strength), tmp_path, state=state))
        total = sum(seconds for seconds, _ in found.values())
        print(f"\n{'again' if number else 'first'}: {len(mesh.vertices)} vertices x {SAMPLES} samples, {total:.2f} s")
        for message, (seconds, processor) in found.items():
            print(f"  {message:32}{seconds:7.3f} s  {seconds / total:5.0%}   of this thread {processor:6.3f} s")


def bench_attributes():
    """What a cache holds of the samples, against one solve for the stream function after the other."""
    data = icosphere(FACES)
    mesh = fields.native_mesh(data)
    axes = np.random.default_rng(0).normal(size=(SAMPLES, 3))
    values = np.stack([mesh.to_tangent(np.cross(axis, data.vertices)) for axis in axes])
    field = native.ParameterizedField(mesh, np.linspace(0.0, 1.0, SAMPLES), values)
    factor = _seconds(lambda: native.start_stream_factor(mesh).result())
    singles = [native.ParameterizedField(mesh, np.zeros(1), values[j : j + 1]) for j in range(SAMPLES)]
    times = {
        "factor, once for a mesh": factor,
        "one after the other": _seconds(lambda: [native.field_attributes(one, one, 0, 1) for one in singles]),
        "together": min(_seconds(lambda: native.field_attributes(field, field, 0, SAMPLES)) for _ in range(3)),
    }
    print()
    for name, seconds in times.items():
        print(f"  {name:28}{1e3 * seconds:7.1f} ms of processor time")
    print(f"  together / one after the other{times['together'] / times['one after the other']:6.2f}")


def bench_solve_in_blender(tmp_path):
    """The same as an artist has it: in a fresh Blender, with what Python imports, and with what follows the cache."""
    script = Path(__file__).with_name("solve_in_blender.py")
    subprocess.run([sys.executable, script, str(FACES), str(SAMPLES), str(tmp_path)], check=True)


def _seconds(work):
    began = time.process_time()
    work()
    return time.process_time() - began
