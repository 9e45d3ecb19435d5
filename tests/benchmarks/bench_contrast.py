# SPDX-License-Identifier: GPL-3.0-or-later
"""How far strokes stand out from what lies below them, at rest and while dashes move.

    .venv/bin/python tests/benchmarks/bench_contrast.py [--picture strokes.png]

Contrasts are those of WCAG, (lighter + 0.05) / (darker + 0.05) of relative luminances, of pixels drawn off-screen.
"""

import argparse

import bpy
import gpu
import numpy as np
import offscreen
from mathutils import Matrix, Vector

#: Where the ball is seen from, and from how far.
SEEN_FROM, DISTANCE = Vector((0.15, -1.0, 0.26)), 3.5
FACES = 20_000


def bench_contrast() -> None:
    run(None)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--picture", help="where to save strokes on the default grey")
    run(parser.parse_args().picture)


def run(picture: str | None) -> None:
    if not offscreen.has_gpu():
        return
    offscreen.start()
    obj = storm_ball()
    with offscreen.view(SEEN_FROM, DISTANCE) as context:
        measure(context, obj, picture)


def storm_ball() -> bpy.types.Object:
    """A sphere on which two storms turn."""
    from stormfield.readers.icosphere import icosphere

    ball = icosphere(FACES)
    mesh = bpy.data.meshes.new("Ball")
    mesh.from_pydata(ball.vertices.tolist(), [], ball.triangles.tolist())
    obj = bpy.data.objects.new("Ball", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.stormfield.add_field()
    values = np.zeros_like(ball.vertices)
    for x in (-0.6, 0.6):
        axis = np.array([x, -1.0, 0.2]) / np.linalg.norm([x, -1.0, 0.2])
        near = np.exp(-((ball.vertices - axis) ** 2).sum(axis=1, keepdims=True) / 0.25) + 0.03
        values += near * np.cross(axis, ball.vertices)
    mesh.attributes.new("sf_advection", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", values.ravel())
    bpy.context.view_layer.update()
    return obj


def backgrounds(width: int, height: int) -> dict[str, np.ndarray]:
    """Pictures (h, w, 3) of sRGB bytes that strokes are drawn over."""
    plain = {"default grey 167": 167, "dark 40": 40, "black": 0, "middle 110": 110, "white": 255}
    made = {name: np.full((height, width, 3), value, np.uint8) for name, value in plain.items()}
    noise = np.random.default_rng(1).integers(0, 256, (height // 8 + 1, width // 8 + 1, 3), dtype=np.uint8)
    made["noise of all colours"] = np.kron(noise, np.ones((8, 8, 1), np.uint8))[:height, :width]
    rows, columns = np.mgrid[:height, :width]
    made["clouds and sea"] = np.where(
        (np.sin(rows / 23) + np.cos(columns / 31) > 0.4)[..., None], np.uint8([235, 238, 240]), np.uint8([18, 60, 96])
    ).astype(np.uint8)
    made["checker"] = np.where((rows // 12 + columns // 12) % 2, 60, 190)[..., None].repeat(3, 2).astype(np.uint8)
    return made


def measure(context: offscreen.Seen, obj, picture: str | None) -> None:
    """On each background, at rest and while dashes move."""
    from stormfield.ui import drawing_cache, overlay

    look = obj.stormfield.look
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    drawing_cache.drawing_of(evaluated)
    seen = overlay.view_of(context, evaluated.matrix_world)
    batch = drawing_cache.strokes_of(evaluated, 1, seen, look.spacing, look.length)
    print("contrast of strokes (5 % of them have less)      at rest    moving")
    for name, below in backgrounds(context.region.width, context.region.height).items():
        row = []
        for phase in (None, 0.3):
            put_picture(below)
            gpu.state.blend_set("ALPHA")
            batch.draw(Matrix(seen.projection), seen.size, seen.scale, stroke_look(look, phase))
            drawn = offscreen.pixels(context)
            row.append(stroke_contrast(below, drawn))
            if picture and name.startswith("default") and phase is None:
                offscreen.save(drawn, picture)
        print(f"    {name:42s}{row[0]:9.2f} {row[1]:9.2f}")


def stroke_look(look, phase: float | None):
    from stormfield.ui.overlay import RIM
    from stormfield.ui.stroke_shader import StrokeLook

    length = look.spacing * look.length
    return StrokeLook(look.spacing, length, look.width, RIM, look.opacity, phase=phase)


def put_picture(picture: np.ndarray) -> None:
    from gpu_extras.presets import draw_texture_2d

    rgba = np.concatenate([picture / 255.0, np.ones((*picture.shape[:2], 1))], axis=2).astype(np.float32)
    data = gpu.types.Buffer("FLOAT", rgba.size, rgba.ravel())
    texture = gpu.types.GPUTexture((picture.shape[1], picture.shape[0]), format="RGBA32F", data=data)
    gpu.state.blend_set("NONE")
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(Matrix.Identity(4))
        gpu.matrix.load_projection_matrix(Matrix.Identity(4))
        draw_texture_2d(texture, (-1, -1), 2, 2)


def luminance(srgb: np.ndarray) -> np.ndarray:
    share = srgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def contrast(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (np.maximum(a, b) + 0.05) / (np.minimum(a, b) + 0.05)


def stroke_contrast(below: np.ndarray, drawn: np.ndarray) -> float:
    """Of blocks of 8 × 8 pixels that strokes cross: the strongest pixel against what was there; 5th percentile."""
    differs = contrast(luminance(below.astype(float)), luminance(drawn.astype(float)))
    touched = (np.abs(drawn.astype(int) - below.astype(int)).max(axis=2) > 8).astype(float)
    block = 8
    rows, columns = below.shape[0] // block, below.shape[1] // block

    def blocks(values):
        return values[: rows * block, : columns * block].reshape(rows, block, columns, block).swapaxes(1, 2)

    crossed = blocks(touched).mean(axis=(2, 3)) > 0.3
    return float(np.percentile(blocks(differs).max(axis=(2, 3))[crossed], 5))


if __name__ == "__main__":
    main()
