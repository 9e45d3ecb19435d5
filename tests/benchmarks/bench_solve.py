# SPDX-License-Identifier: GPL-3.0-or-later
"""From Solve to a cache that Blender can show, in parts: 41 000 vertices, 60 samples of λ, as an artist edits it.

python -m pytest -s tests/benchmarks/bench_solve.py (settings in tests/benchmarks/pytest.ini)

The second solve starts from the first, as in a window. "of this thread" is processor time of Python's thread: the rest
is the core's own threads, or waiting for them and for the disk.
"""

import time

import numpy as np
from stormfield.bake.lambda_cache import solve_steps
from stormfield.cache import fields
from stormfield.cache.rotation import Rotation
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


def bench_rotation():
    """Against the sum over faces and edges, as the definition says it."""
    data = icosphere(FACES)
    mesh = fields.native_mesh(data)
    vectors = np.random.default_rng(0).normal(size=data.vertices.shape)
    rotation = Rotation(mesh)

    def by_definition():
        corners, flow = mesh.vertices[mesh.triangles], vectors[mesh.triangles]
        edges = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
        return sum(np.einsum("ij,ij->i", flow[:, k] + flow[:, (k + 1) % 3], edges[k]) / 2 for k in range(3))

    times = {}
    for name, work in (("rotation", lambda: rotation.of(vectors)), ("circulations by definition", by_definition)):
        times[name] = min(_seconds(work) for _ in range(5))
        print(f"  {name:28}{1e3 * times[name]:7.2f} ms")
    print(f"  rotation / circulations     {times['rotation'] / times['circulations by definition']:7.2f}")


def _seconds(work):
    began = time.thread_time()
    work()
    return time.thread_time() - began
