# SPDX-License-Identifier: GPL-3.0-or-later
"""Solve in a fresh Blender, three times: as it is, after one element moved, and after no change. Prints the parts.

python tests/benchmarks/solve_in_blender.py FACES SAMPLES FOLDER
"""

import sys
import time
from functools import wraps
from pathlib import Path

BEGAN = time.perf_counter()


class Parts:
    """Seconds by part, in the order in which they were met."""

    def __init__(self):
        self.seconds = {}

    def timed(self, name, work):
        @wraps(work)
        def call(*arguments, **named):
            began = time.perf_counter()
            try:
                return work(*arguments, **named)
            finally:
                self.add(name, time.perf_counter() - began)

        return call

    def add(self, name, seconds):
        self.seconds[name] = self.seconds.get(name, 0.0) + seconds

    def steps(self, made):
        """The same steps; what follows each is counted for its message."""
        message, began = "Reading the mesh", time.perf_counter()
        try:
            while True:
                step = next(made)
                now = time.perf_counter()
                self.add(f"  {message}", now - began)
                yield step
                message, began = step.message, now
        except StopIteration as end:
            self.add(f"  {message}", time.perf_counter() - began)
            return end.value

    def show(self, title):
        total = sum(seconds for name, seconds in self.seconds.items() if not name.startswith(" "))
        print(f"\n{title}: {total:.2f} s")
        for name, seconds in self.seconds.items():
            print(f"  {name:36}{seconds:7.3f} s  {seconds / total:5.0%}")
        self.seconds.clear()
        return total


def scene(bpy, faces, samples):
    """An icosphere with two storms that drift together, and a jet."""
    from stormfield.readers.icosphere import icosphere
    from stormfield.scene.write.elements import add_element

    data = icosphere(faces)
    mesh = bpy.data.meshes.new("Planet")
    mesh.from_pydata(data.vertices, [], data.triangles)
    planet = bpy.data.objects.new("Planet", mesh)
    bpy.context.collection.objects.link(planet)
    bpy.context.view_layer.objects.active = planet
    bpy.ops.stormfield.add_field()
    planet.stormfield.solve.samples = samples

    def drawn(name, points, **settings):
        curve = bpy.data.curves.new(name, "CURVE")
        curve.dimensions = "3D"
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        for target, point in zip(spline.points, points, strict=True):
            target.co = (*point, 1.0)
        obj = bpy.data.objects.new(name, curve)
        bpy.context.collection.objects.link(obj)
        element = add_element(planet, obj, **settings)
        return obj, element

    storm = {"type": "singular", "kind": "vortex_ccw", "radius": 0.1, "lam_start": 0.0, "lam_end": 0.6}
    drawn("West", [(0.9, -0.3, 0.2), (0.97, 0.0, 0.25)], **storm)
    east, _ = drawn("East", [(0.9, 0.3, 0.2), (0.97, 0.0, 0.25)], **storm)
    drawn("Jet", [(1, 0, 0), (0.7, 0.7, 0), (0, 1, 0)], type="streamline")
    return planet, east


def main(faces, samples, folder):
    parts = Parts()
    import bpy

    parts.add("Blender (the bpy module)", time.perf_counter() - BEGAN)
    parts.timed("Stormfield", lambda: __import__("stormfield").register())()
    from stormfield import native
    from stormfield.cache import usd

    parts.timed("The core", native.check)()
    parts.timed("USD", usd.usd)()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "work.blend"))
    parts.show("Start, and what the first solve would import otherwise")

    from stormfield.operators import solve
    from stormfield.solve import SolverState

    planet, east = scene(bpy, faces, samples)
    state = SolverState()
    solve.solver_state.of = lambda _obj: state  # as in a window, where a second solve starts from the first
    operator = solve.STORMFIELD_OT_solve
    start, finish = solve.SolvingOperator.start, solve.SolvingOperator.finish
    operator.start = parts.timed("Reading the scene", lambda *given: parts.steps(start(*given)))
    operator.finish = parts.timed("Attaching, and looking for doubts", finish)

    def solved(title):
        began = time.perf_counter()
        bpy.ops.stormfield.solve()
        total = time.perf_counter() - began
        inside = sum(seconds for name, seconds in parts.seconds.items() if not name.startswith(" "))
        parts.add("Solving and writing", total - inside)
        parts.timed("The picture: Blender reads the cache", bpy.context.evaluated_depsgraph_get().update)()
        attributes = planet.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes
        assert "sf_advection" in attributes, "the field is not there"
        return parts.show(title)

    sizes = f"{len(planet.data.vertices)} vertices x {samples} samples"
    first = solved(f"First solve, {sizes}")
    for point in east.data.splines[0].points:
        point.co.x += 0.02
    again = solved("Again, after one element moved")
    print(f"\nagain / first {again / first:.2f}")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]))
    __import__("stormfield").unregister()
