# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay costs when λ changes and when nothing does, and how far strokes stand out from what lies below.

    .venv/bin/python tests/benchmarks/bench_overlay.py [--faces 328000] [--picture strokes.png]

Draws off-screen, which needs a Blender with gpu.init (5.2) and an OpenGL or Vulkan driver. The driver's own work is
printed but not added up: a software driver draws on the cores that everything else needs. Prints milliseconds by part,
the best of several rounds, and contrasts
(WCAG: (lighter + 0.05) / (darker + 0.05) of relative luminances) of drawn pixels.
"""

import argparse
import time

import bpy
import gpu
import numpy as np
from mathutils import Matrix, Vector

SIZE = (1280, 720)
ROUNDS = 15


def bench_overlay() -> None:
    run(328_000, None)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--faces", type=int, default=328_000)
    parser.add_argument("--picture", help="where to save strokes on the default grey")
    options = parser.parse_args()
    run(options.faces, options.picture)


def run(faces: int, picture: str | None) -> None:
    if not hasattr(gpu, "init"):
        print("this Blender draws only in a window: use Blender 5.2 or later")
        return
    gpu.init()
    import stormfield

    stormfield.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = storm_ball(faces)
    target = gpu.types.GPUOffScreen(*SIZE, format="RGBA8")
    with target.bind():
        measure_cost(obj)
        measure_contrast(obj, picture)
        stormfield.unregister()  # gives back what the GPU holds, while it is there
    target.free()


def storm_ball(faces: int) -> bpy.types.Object:
    """A sphere on which two storms turn."""
    from stormfield.readers.icosphere import icosphere

    ball = icosphere(faces)
    mesh = bpy.data.meshes.new("Ball")
    mesh.from_pydata(ball.vertices.tolist(), [], ball.triangles.tolist())
    obj = bpy.data.objects.new("Ball", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.stormfield.add_field()
    put_field(obj, 0.0)
    return obj


def put_field(obj, lam: float) -> None:
    vertices = np.empty(len(obj.data.vertices) * 3, np.float32)
    obj.data.vertices.foreach_get("co", vertices)
    vertices = vertices.reshape(-1, 3)
    values = np.zeros_like(vertices)
    for x in (-0.6, 0.6 - 0.4 * lam):
        axis = np.array([x, -1.0, 0.2]) / np.linalg.norm([x, -1.0, 0.2])
        near = np.exp(-((vertices - axis) ** 2).sum(axis=1, keepdims=True) / 0.25) + 0.03
        values += near * np.cross(axis, vertices).astype(np.float32)
    attribute = obj.data.attributes.get("sf_advection") or obj.data.attributes.new(
        "sf_advection", "FLOAT_VECTOR", "POINT"
    )
    attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
    obj.data.update_tag()
    bpy.context.view_layer.update()


def camera():
    """View and projection of a view that shows the whole ball, and its scale."""
    place = Vector((0.5, -3.4, 0.9))
    world = Matrix.Translation(place) @ (-place).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    focus, near, far = 2.9, 0.1, 100.0
    aspect = SIZE[1] / SIZE[0]
    projection = Matrix(
        (
            (focus * aspect, 0, 0, 0),
            (0, focus, 0, 0),
            (0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)),
            (0, 0, -1, 0),
        )
    )
    return projection @ world.inverted(), place, 0.5 * SIZE[1] * focus


def view():
    from stormfield.ui.stroke_view import View

    matrix, place, scale = camera()
    return matrix, View(np.array(matrix), SIZE, scale, np.array((*place, 1.0)))


def finish() -> None:
    """Wait for the GPU."""
    gpu.state.active_framebuffer_get().read_color(0, 0, 1, 1, 4, 0, "UBYTE")


def measure_cost(obj) -> None:
    from stormfield.ui import drawing_cache

    matrix, seen = view()
    look = obj.stormfield.look
    parts: dict[str, list[tuple[float, float]]] = {}
    counts: list[int] = []

    def timed(name, work):
        start, start_thread = time.perf_counter(), time.thread_time()
        result = work()
        spent = 1e3 * (time.perf_counter() - start), 1e3 * (time.thread_time() - start_thread)
        parts.setdefault(name, []).append(spent)
        return result

    def draw(kind: str) -> None:
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        timed(f"{kind}: is the shape the same", lambda: drawing_cache.surface_of(evaluated))
        timed(f"{kind}: field and fixed points", lambda: drawing_cache.drawing_of(evaluated))
        batch = timed(
            f"{kind}: strokes", lambda: drawing_cache.strokes_of(evaluated, 1, seen, look.spacing, look.length)
        )
        timed(f"{kind}: draw calls, by the driver", lambda: batch.draw(matrix, SIZE, seen.scale, stroke_look(look)))
        timed(f"{kind}: pixels, by the driver", finish)
        counts.append(batch.count)

    draw("first picture")
    for round_number in range(ROUNDS):
        obj.stormfield.lam = (round_number + 1) / ROUNDS
        put_field(obj, obj.stormfield.lam)
        drawing_cache.mark_changed(bpy.context.evaluated_depsgraph_get())
        draw("λ changes")
        draw("nothing changes")
    print(f"{len(obj.data.polygons)} faces, {counts[-1]} strokes, {SIZE[0]} × {SIZE[1]}")
    print(f"best of {ROUNDS}, ms{'':31s}    clock   Blender's thread")
    for kind in ("first picture", "λ changes", "nothing changes"):
        mine = {name: np.min(times, axis=0) for name, times in parts.items() if name.startswith(kind)}
        wall, thread = sum(best for name, best in mine.items() if "driver" not in name)
        print(f"{kind:42s}{wall:9.2f} {thread:9.2f}")
        for name, (wall, thread) in mine.items():
            print(f"    {name.split(': ')[1]:38s}{wall:9.2f} {thread:9.2f}")


def stroke_look(look, **changes):
    from stormfield.ui.stroke_shader import StrokeLook

    settings = {
        "distance": look.spacing,
        "length": look.spacing * look.length,
        "width": look.width,
        "rim": 1.2,
        "opacity": look.opacity,
    }
    return StrokeLook(**settings | changes)


# Contrast -------------------------------------------------------------------------------------------------------------


def backgrounds():
    """Pictures (h, w, 3) of sRGB bytes that strokes are drawn over."""
    height, width = SIZE[1], SIZE[0]
    plain = {"default grey 167": 167, "dark 40": 40, "black": 0, "middle 110": 110, "white": 255}
    made = {name: np.full((height, width, 3), value, np.uint8) for name, value in plain.items()}
    noise = np.random.default_rng(1).integers(0, 256, (height // 8, width // 8, 3), dtype=np.uint8)
    made["noise of all colours"] = np.kron(noise, np.ones((8, 8, 1), np.uint8))
    rows, columns = np.mgrid[:height, :width]
    made["clouds and sea"] = np.where(
        (np.sin(rows / 23) + np.cos(columns / 31) > 0.4)[..., None], np.uint8([235, 238, 240]), np.uint8([18, 60, 96])
    ).astype(np.uint8)
    made["checker"] = np.where((rows // 12 + columns // 12) % 2, 60, 190)[..., None].repeat(3, 2).astype(np.uint8)
    return made


def measure_contrast(obj, picture: str | None) -> None:
    """On each background, at rest and while dashes move."""
    from stormfield.ui import drawing_cache

    matrix, seen = view()
    look = obj.stormfield.look
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    drawing_cache.drawing_of(evaluated)
    batch = drawing_cache.strokes_of(evaluated, 1, seen, look.spacing, look.length)
    gpu.state.blend_set("ALPHA")
    print("contrast of strokes (5 % of them have less)      at rest    moving")
    for name, below in backgrounds().items():
        row = []
        for phase in (None, 0.3):
            put_picture(below)
            batch.draw(matrix, SIZE, seen.scale, stroke_look(look, phase=phase))
            drawn = read_picture()
            row.append(stroke_contrast(batch, below, drawn))
            if picture and name.startswith("default") and phase is None:
                save(drawn, picture)
        print(f"    {name:42s}{row[0]:9.2f} {row[1]:9.2f}")


def put_picture(picture: np.ndarray) -> None:
    from gpu_extras.presets import draw_texture_2d

    rgba = np.concatenate([picture / 255.0, np.ones((*picture.shape[:2], 1))], axis=2).astype(np.float32)
    data = gpu.types.Buffer("FLOAT", rgba.size, rgba.ravel())
    texture = gpu.types.GPUTexture(SIZE, format="RGBA32F", data=data)
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(Matrix.Identity(4))
        gpu.matrix.load_projection_matrix(Matrix.Identity(4))
        draw_texture_2d(texture, (-1, -1), 2, 2)


def read_picture() -> np.ndarray:
    buffer = gpu.state.active_framebuffer_get().read_color(0, 0, *SIZE, 4, 0, "UBYTE")
    return np.array(buffer, dtype=np.uint8).reshape(SIZE[1], SIZE[0], 4)[..., :3]


def luminance(srgb: np.ndarray) -> np.ndarray:
    share = srgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def contrast(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (np.maximum(a, b) + 0.05) / (np.minimum(a, b) + 0.05)


def stroke_contrast(batch, below: np.ndarray, drawn: np.ndarray) -> float:
    """Of blocks of 8 × 8 pixels that strokes cross: the strongest pixel against what was there; 5th percentile."""
    differs = contrast(luminance(below.astype(float)), luminance(drawn.astype(float)))
    touched = (np.abs(drawn.astype(int) - below.astype(int)).max(axis=2) > 8).astype(float)
    block = 8
    rows, columns = SIZE[1] // block, SIZE[0] // block

    def blocks(values):
        return values[: rows * block, : columns * block].reshape(rows, block, columns, block).swapaxes(1, 2)

    crossed = blocks(touched).mean(axis=(2, 3)) > 0.3
    return float(np.percentile(blocks(differs).max(axis=(2, 3))[crossed], 5))


def save(pixels: np.ndarray, path: str) -> None:
    image = bpy.data.images.new("strokes", *SIZE)
    rgba = np.concatenate([pixels / 255.0, np.ones((*pixels.shape[:2], 1))], axis=2)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()


if __name__ == "__main__":
    main()
