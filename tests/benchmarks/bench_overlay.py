# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay costs when λ changes and when nothing does, with all that it can draw.

    .venv/bin/python tests/benchmarks/bench_overlay.py [--subdivisions 8] [--picture overlay.png] [--profile]

Solves the storm merge on a sphere (8 subdivisions: 327,680 faces), analyzes it at one λ and over λ, and draws field,
strokes, fixed points, elements, curves, markers, names and legend as the draw handlers do, off-screen. The driver's own
work is printed beside it: a software driver draws on the cores that everything else needs. It is measured in rounds of
their own, since measuring it slows down what is around it. Prints milliseconds by the clock and of Blender's thread,
the best of several rounds.
"""

import argparse
import cProfile
import pstats
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace

import bpy
import gpu
import offscreen
from mathutils import Matrix, Vector

ROUNDS = 15
#: Samples of λ: enough to follow the storms.
SAMPLES = 7
DISTANCE = 3.2
#: Parts of the names of what works inside the driver.
DRIVER = ("of 'GPUBatch'", "of 'GPUShader'", "of 'GPUFrameBuffer'", "GPUTexture", "blf.draw")


def bench_overlay() -> None:
    run(SimpleNamespace(subdivisions=8, picture=None, profile=False))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--subdivisions", type=int, default=8, help="of the sphere")
    parser.add_argument("--picture", help="where to save what is drawn")
    parser.add_argument("--profile", action="store_true", help="print which functions take the time")
    run(parser.parse_args())


def run(options) -> None:
    if not offscreen.has_gpu():
        return
    offscreen.start()
    planet = merging_storms(options.subdivisions)
    from stormfield.presets import storm_merge

    with offscreen.view(Vector(storm_merge.on_sphere(*storm_merge.SEEN_FROM)), DISTANCE) as context:
        measure(context, planet, options.profile)
        if options.picture:
            offscreen.save(offscreen.pixels(context), options.picture)


def merging_storms(subdivisions: int) -> bpy.types.Object:
    """The planet of the storm merge, solved and analyzed, with everything shown and something selected."""
    from stormfield.presets import storm_merge

    planet = storm_merge.build_planet(bpy.context.scene, subdivisions)
    bpy.context.view_layer.objects.active = planet
    planet.select_set(True)
    planet.stormfield.solve.samples = SAMPLES
    planet.stormfield.solve.keep_solver = False
    bpy.ops.stormfield.solve("EXEC_DEFAULT")
    bpy.context.scene.frame_set(60)
    bpy.ops.stormfield.analyze("EXEC_DEFAULT")
    bpy.ops.stormfield.analyze_lambda("EXEC_DEFAULT")
    planet.stormfield.analysis.show_names = True
    planet.stormfield.active_element = planet.stormfield.elements.find("Storm West")
    return planet


def measure(context: offscreen.Seen, planet, profiled: bool) -> None:
    from stormfield.ui import overlay

    spent: dict[str, list[tuple[float, float]]] = {}
    profile = cProfile.Profile(time.thread_time)

    def timed(name: str, work: Callable[[], None]) -> None:
        start, start_thread = time.perf_counter(), time.thread_time()
        work()
        times = 1e3 * (time.perf_counter() - start), 1e3 * (time.thread_time() - start_thread)
        spent.setdefault(name, []).append(times)

    def draw(kind: str) -> None:
        offscreen.clear((0.4, 0.4, 0.4))
        offscreen.finish()
        with view_space(context):
            timed(f"{kind}: in the view", lambda: overlay.draw_field(context))
        with pixel_space(context):
            timed(f"{kind}: names and legend", lambda: overlay.draw_texts(context))
        offscreen.finish()

    draw("first picture")
    driver: dict[str, list[float]] = {}
    for number in range(2 * ROUNDS):
        bpy.context.scene.frame_set(30 + 7 * number)
        for kind in ("λ changes", "nothing changes"):
            if number < ROUNDS:
                draw(kind)
                continue
            one = cProfile.Profile(time.thread_time)
            one.runcall(draw, "profiled")
            driver.setdefault(kind, []).append(driver_time(one))
            if kind == "λ changes":
                profile = one
    print(f"{len(planet.data.polygons)} faces, {context.region.width} × {context.region.height}")
    print(f"best of {ROUNDS}, ms{'':31s}    clock   Blender's thread   of it the driver")
    for kind in ("first picture", "λ changes", "nothing changes"):
        parts = {name: min(times, key=lambda t: t[1]) for name, times in spent.items() if name.startswith(kind)}
        wall, thread = (sum(part[i] for part in parts.values()) for i in (0, 1))
        calls = f"{min(driver[kind]):9.2f}" if kind in driver else ""
        print(f"{kind:42s}{wall:9.2f} {thread:9.2f} {calls}")
        for name, (wall, thread) in parts.items():
            print(f"    {name.split(': ')[1]:38s}{wall:9.2f} {thread:9.2f}")
    if profiled:
        pstats.Stats(profile).sort_stats("cumtime").print_stats(60)


def driver_time(profile: cProfile.Profile) -> float:
    """Milliseconds inside calls of the driver."""
    return 1e3 * sum(entry.inlinetime for entry in profile.getstats() if is_driver(entry.code))


def is_driver(code) -> bool:
    """Whether a function, as the profiler names it, hands work to the GPU or waits for it."""
    return isinstance(code, str) and any(name in code for name in DRIVER)


def view_space(context: offscreen.Seen):
    seen = context.region_data
    return matrices(seen.view_matrix, seen.window_matrix)


def pixel_space(context: offscreen.Seen):
    width, height = context.region.width, context.region.height
    return matrices(
        Matrix.Identity(4), Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, -1, 0), (0, 0, 0, 1)))
    )


@contextmanager
def matrices(model: Matrix, projection: Matrix) -> Iterator[None]:
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(model)
        gpu.matrix.load_projection_matrix(projection)
        yield


if __name__ == "__main__":
    main()
