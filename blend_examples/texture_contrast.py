# SPDX-License-Identifier: GPL-3.0-or-later
"""Contrast over time of the materials on the storm merge: does texture pulse when phases change?

    python blend_examples/texture_contrast.py [--detail 0] [--frames 84] [--every 4] [--out FOLDER]

The planet is rendered with the colours of a material alone, without light, and for each frame the deviation of the
colours in the planet's disc is printed as a fraction of its mean over the frames, and for materials from an image as a
fraction of the image's. Writes a still of each with light beside it.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example

PIXELS, STILL = 480, 40


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=example.REPOSITORY / "out" / "texture_contrast")
    parser.add_argument("--frames", type=int, default=84, help="length of the animation")
    parser.add_argument("--every", type=int, default=4, help="frames from one that is measured to the next")
    parser.add_argument(
        "--detail", type=int, default=-1, help="0: the whole mesh; each step down is a quarter of its faces"
    )
    given = parser.parse_args()
    options = example.Options(given.out, given.frames, 100, None, given.detail, "none", False)
    example.begin(options)
    planet = example.part("presets.storm_merge").build(bpy.context, 7 + given.detail, given.frames)
    example.solve_and_bake(options, planet, "texture_contrast")
    strokes = image_of("Brush Strokes", brush_strokes())
    from_image = example.part("shading.from_image").material_from_image
    shading = example.part("shading")
    looks = {
        "Storm Clouds": (shading.build_material("storm_clouds", relief=0.0), None),
        "From Image": (from_image(strokes, 0.5)[0], np.asarray(strokes.pixels).reshape(-1, 4)[:, :3]),
        "Fibres": (shading.build_material("fibres"), None),
    }
    for name, (material, source) in looks.items():
        planet.data.materials[0] = material
        still(given.out / f"{name.lower().replace(' ', '_')}.png")
        frames = range(1, given.frames + 1, given.every)
        measured = np.array([deviation(frame, material) for frame in frames])
        ratio = measured / measured.mean()
        print(f"{name}: contrast over time {ratio.min():.3f} to {ratio.max():.3f} of its mean", flush=True)
        if source is not None:
            over = measured / np.linalg.norm(source.std(axis=0))
            print(
                f"{name}: contrast {over.min():.3f} to {over.max():.3f} of the image's, mean {over.mean():.3f}",
                flush=True,
            )


def still(path: Path) -> None:
    scene = bpy.context.scene
    scene.frame_set(STILL)
    render = scene.render
    render.resolution_x = render.resolution_y = PIXELS
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    print(f"still: {path}", flush=True)


def deviation(frame: int, material: bpy.types.Material) -> float:
    """Length of the deviations of red, green and blue in the disc, without light."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    tree: Any = material.node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    lit = output.inputs["Surface"].links[0].from_socket
    glow = tree.nodes.new("ShaderNodeEmission")
    colour = lit.node.inputs["Color" if "Color" in lit.node.inputs else "Base Color"].links[0].from_socket
    tree.links.new(colour, glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    pixels = plain_pixels(scene)
    tree.links.new(lit, output.inputs["Surface"])
    tree.nodes.remove(glow)
    disc = pixels[pixels[:, 3] > 0.999, :3].astype(np.float64)
    return float(np.linalg.norm(disc.std(axis=0)))


def plain_pixels(scene: Any) -> np.ndarray:
    """The picture as numbers (n, 4), scene-linear, one sample a pixel, nothing behind the planet."""
    render = scene.render
    kept = {
        (owner, name): getattr(owner, name)
        for owner, names in (
            (render, ("filter_size", "film_transparent", "filepath")),
            (scene.cycles, ("samples", "use_denoising")),
            (scene.view_settings, ("view_transform", "look")),
            (render.image_settings, ("file_format", "color_depth", "color_mode")),
        )
        for name in names
    }
    render.filter_size, render.film_transparent = 0.01, True
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.view_settings.view_transform, scene.view_settings.look = "Raw", "None"
    settings = render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    render.filepath = str(Path(bpy.app.tempdir) / "plain.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    for (owner, name), value in kept.items():
        setattr(owner, name, value)
    return pixels.reshape(-1, 4)


def brush_strokes(side: int = 512, strokes: int = 2600) -> np.ndarray:
    """Strokes of paint along the first axis, whose sides fit together: (side, side, 4), scene-linear."""
    random = np.random.default_rng(11)
    palette = np.array([[0.02, 0.05, 0.2], [0.05, 0.2, 0.45], [0.5, 0.55, 0.5], [0.75, 0.45, 0.08], [0.9, 0.8, 0.5]])
    canvas = np.broadcast_to(palette[0], (side, side, 3)).copy()
    for _ in range(strokes):
        length, width = int(random.uniform(30, 90)), int(random.uniform(4, 10))
        x, y = np.mgrid[-width : width + 1, -length : length + 1][::-1]
        bristles = 0.75 + 0.5 * random.random(2 * width + 1)[:, None] * random.random((1, 1))
        inside = (x / length) ** 4 + (y / width) ** 2 < 1.0 - 0.5 * random.random((2 * width + 1, 1))
        at = (y + int(random.integers(side))) % side, (x + int(random.integers(side))) % side
        colour = palette[random.integers(len(palette))] * random.uniform(0.7, 1.2)
        painted = np.clip(colour * bristles[..., None], 0.0, 1.0)
        canvas[at] = np.where(inside[..., None], painted, canvas[at])
    return np.concatenate([canvas, np.ones((side, side, 1))], axis=-1)


def image_of(name: str, pixels: np.ndarray) -> Any:
    height, width = pixels.shape[:2]
    image: Any = bpy.data.images.new(name, width, height, float_buffer=True)
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    return image


if __name__ == "__main__":
    example.run(main)
