# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay costs when λ changes and when nothing does, with all that it can draw.

    .venv/bin/python tests/benchmarks/bench_overlay.py [--subdivisions 8] [--picture overlay.png] [--profile]

Solves the storm merge on a sphere (8 subdivisions: 327,680 faces), analyzes it at one λ and over λ, and draws field,
strokes, fixed points, elements, curves, markers, names and legend as the draw handlers do, off-screen. A software
driver draws on the cores that everything else needs; the overlay's own work is therefore measured with draw calls left
out, and what they add is printed beside it. Milliseconds of Blender's thread.
"""

import argparse
import cProfile
import pstats
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace
from unittest.mock import patch

import bpy
import gpu
import numpy as np
import offscreen
from mathutils import Matrix, Vector

ROUNDS = 15
#: Samples of λ: enough to follow the storms.
SAMPLES = 7
DISTANCE = 3.2
KINDS = ("λ changes", "nothing changes")


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
    from stormfield.session import freshness

    freshness.PAUSE = 0.25  # as in a window
    with offscreen.view(Vector(storm_merge.on_sphere(*storm_merge.SEEN_FROM)), DISTANCE) as context:
        print(f"{len(planet.data.polygons)} faces, {context.region.width} × {context.region.height}")
        measure(context)
        if options.profile:
            profile(context)
        if options.picture:
            offscreen.clear((0.4, 0.4, 0.4))
            draw(context)
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


def measure(context: offscreen.Seen) -> None:
    """Twice through the frames: what is made at a place of an element's path for the first time is told apart."""
    draw(context)
    with silent_driver():
        first, own = through_frames(context), through_frames(context)
    whole = through_frames(context)
    print(f"{'':22s}{'overlay':>9s}{'  (first time through)':s}{'  with the driver':s}")
    for kind in KINDS:
        print(f"{kind:22s}{own[kind]:9.2f}{first[kind]:22.2f}{whole[kind]:17.2f}")


def through_frames(context: offscreen.Seen) -> dict[str, float]:
    """Median milliseconds for a frame that is new, and for the same once more."""
    spent: dict[str, list[float]] = {kind: [] for kind in KINDS}
    for frame in np.linspace(1, 250, ROUNDS).round().astype(int).tolist():
        bpy.context.scene.frame_set(frame)
        for kind in KINDS:
            offscreen.finish()
            began = time.thread_time()
            draw(context)
            spent[kind].append(1e3 * (time.thread_time() - began))
    return {kind: float(np.median(times)) for kind, times in spent.items()}


def draw(context: offscreen.Seen) -> None:
    from stormfield.ui import overlay

    seen, (width, height) = context.region_data, (context.region.width, context.region.height)
    with matrices(seen.view_matrix, seen.window_matrix):
        overlay.draw_field(context)
    pixels = Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, -1, 0), (0, 0, 0, 1)))
    with matrices(Matrix.Identity(4), pixels):
        overlay.draw_texts(context)


@contextmanager
def matrices(model: Matrix, projection: Matrix) -> Iterator[None]:
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(model)
        gpu.matrix.load_projection_matrix(projection)
        yield


@contextmanager
def silent_driver() -> Iterator[None]:
    """Batches are made, and not drawn."""
    from gpu_extras.batch import batch_for_shader
    from stormfield.ui import analysis_overlay, legend, marker_drawing, overlay, polylines, stroke_shader, view_text

    def made(*arguments, **named):
        return SimpleNamespace(made=batch_for_shader(*arguments, **named), draw=lambda _shader: None)

    overlay.forget()
    with ExitStack() as patches:
        for module in (analysis_overlay, legend, marker_drawing, polylines, view_text):
            patches.enter_context(patch.object(module, "batch_for_shader", made))
        patches.enter_context(patch.object(stroke_shader.StrokeBatch, "draw", lambda *_: None))
        patches.enter_context(patch("blf.draw", lambda *_: None))
        draw(offscreen.Seen(bpy.context))
        yield
    overlay.forget()
    draw(offscreen.Seen(bpy.context))


def profile(context: offscreen.Seen) -> None:
    with silent_driver():
        through_frames(context)
        for work in (lambda: through_frames(context), lambda: [draw(context) for _ in range(ROUNDS)]):
            seen = cProfile.Profile(time.thread_time)
            seen.runcall(work)
            pstats.Stats(seen).sort_stats("cumtime").print_stats(50)


if __name__ == "__main__":
    main()
