# SPDX-License-Identifier: GPL-3.0-or-later
"""What the examples share: options, a clean scene with the add-on, solve and bake through its operators, frames, film.

Every example runs as `python build_X.py [options]` where `bpy` and `stormfield` are installed, and as
`blender --background --python build_X.py -- [options]`.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import bpy
import flicker

REPOSITORY = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Options:
    out: Path  # folder of the .blend, the cache, frames and film
    frames: int  # length of the animation
    percentage: int  # of the full resolution
    samples: int | None  # per pixel; None: as the example has it
    detail: int  # 0: as the example has it; each step down is a quarter of the faces
    render: str  # all, still or none
    film: bool


def parse(name: str, description: str, frames: int) -> Options:
    """The command line, after `--` inside Blender."""
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if Path(sys.argv[0]).name.startswith("blender") and "--" not in sys.argv:
        given = []
    parser = argparse.ArgumentParser(prog=f"build_{name}.py", description=description)
    parser.add_argument("--out", type=Path, default=REPOSITORY / "out" / name, help="folder of everything made")
    parser.add_argument("--frames", type=int, default=frames, help="length of the animation")
    parser.add_argument("--percentage", type=int, default=100, help="of the full resolution")
    parser.add_argument("--samples", type=int, help="per pixel")
    parser.add_argument("--detail", type=int, default=0, help="-1: a quarter of the faces")
    parser.add_argument("--render", choices=("all", "still", "none"), default="all")
    parser.add_argument("--no-film", dest="film", action="store_false")
    return Options(**vars(parser.parse_args(given)))


def stormfield() -> ModuleType:
    """The add-on, registered: the installed package, or the extension where Blender has it enabled."""
    enabled = [name for name in sys.modules if name.startswith("bl_ext.") and name.endswith(".stormfield")]
    module = importlib.import_module(enabled[0] if enabled else "stormfield")
    if not hasattr(bpy.types.Object, "stormfield"):
        module.register()
    return module


def part(name: str) -> ModuleType:
    """A module of the add-on, such as 'presets.storm_merge'."""
    return importlib.import_module(f"{stormfield().__name__}.{name}")


def begin(options: Options) -> None:
    """An empty scene with the add-on."""
    options.out.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    stormfield()


def solve_and_bake(options: Options, obj: bpy.types.Object, name: str) -> Path:
    """Save, solve over λ, bake every frame, save again. Returns the .blend, which needs no add-on to render."""
    return _save_after(options, obj, name, (bpy.ops.stormfield.solve, bpy.ops.stormfield.bake))


def bake(options: Options, obj: bpy.types.Object, name: str) -> Path:
    """The same of a field that is there already: imported, or of an attribute."""
    return _save_after(options, obj, name, (bpy.ops.stormfield.bake,))


def _save_after(options: Options, obj: bpy.types.Object, name: str, steps: tuple) -> Path:
    scene = bpy.context.scene
    scene.render.resolution_percentage = options.percentage
    if options.samples:
        scene.cycles.samples = options.samples
    blend = options.out / f"{name}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    bpy.context.view_layer.objects.active = obj
    for step in steps:
        began = time.perf_counter()
        if step() != {"FINISHED"}:
            raise SystemExit(f"{step.idname_py()} did not finish")
        print(f"{step.idname_py().removeprefix('stormfield.')}: {time.perf_counter() - began:.1f} s", flush=True)
    bpy.ops.wm.save_mainfile()
    print(f"scene: {blend}", flush=True)
    return blend


def print_flicker(obj: bpy.types.Object, keys: int = 6) -> None:
    """The solved field's flicker and that of linear interpolation between key frames taken from it."""
    attached, native = part("scene.read.attached"), part("native")
    cache = part("cache.field_cache").open_cache(attached.attached_folder(obj, attached.LAMBDA))
    solved = cache.values("sf_advection")
    weights = flicker.vertex_areas(cache.mesh.vertices, cache.mesh.triangles)
    mesh = native.TriangleMesh(cache.mesh.vertices, cache.mesh.triangles)
    for name, fields in (("solved", solved), (f"linear between {keys} keys", flicker.interpolated(solved, keys))):
        percent, changes = flicker.flicker(fields, weights), flicker.topology_changes(mesh, fields, native)
        print(f"flicker, {name}: {percent:.3f} % per step, {changes} fixed points appear or vanish", flush=True)


def render(options: Options, name: str, still: int) -> list[Path]:
    """PNG frames (all of them, or the still alone) and the film; says where they are."""
    scene = bpy.context.scene
    folder = options.out / "frames"
    folder.mkdir(exist_ok=True)
    if options.render == "none":
        return []
    frames = [still] if options.render == "still" else list(range(scene.frame_start, scene.frame_end + 1))
    paths = []
    began = time.perf_counter()
    for frame in frames:
        paths.append(folder / f"{name}_{frame:04d}.png")
        scene.frame_set(frame)
        scene.render.filepath = str(paths[-1])
        bpy.ops.render.render(write_still=True)
        each = (time.perf_counter() - began) / len(paths)
        print(f"frame {frame}: {each:.1f} s each, {each * (len(frames) - len(paths)):.0f} s left", flush=True)
    print(f"frames: {folder}", flush=True)
    if options.film and len(paths) > 1:
        print(f"film: {write_film(paths, options.out / f'{name}.mp4', scene.render.fps)}", flush=True)
    return paths


def run(main: Callable[[], None]) -> None:
    """An example as a program. In Blender itself it only returns; the module bpy is left as `stormfield` leaves it."""
    if not bpy.app.module:
        main()
        return
    status: object = 0
    try:
        main()
    except SystemExit as end:
        status = end.code or 0
        if isinstance(status, str):
            print(status, file=sys.stderr)
    except BaseException:
        status = 1
        traceback.print_exc()
    status = status if isinstance(status, int) else 1
    if hasattr(bpy.types.Object, "stormfield"):
        part("cli.blender").leave(status)
    sys.exit(status)


def write_film(pictures: list[Path], film: Path, fps: int) -> Path:
    """H.264 through Blender's own sequencer; the pictures' colours are kept as they are."""
    first = bpy.data.images.load(str(pictures[0]))
    width, height = first.size
    bpy.data.images.remove(first)
    scene = bpy.data.scenes.new("Film")
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width // 2 * 2, height // 2 * 2, 100
    render.fps, scene.frame_start, scene.frame_end = fps, 1, len(pictures)
    scene.view_settings.view_transform = "Standard"
    strip = scene.sequence_editor_create().strips.new_image("frames", str(pictures[0]), channel=1, frame_start=1)
    for picture in pictures[1:]:
        strip.elements.append(picture.name)
    settings = render.image_settings
    if hasattr(settings, "media_type"):  # since Blender 5
        settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"
    render.ffmpeg.constant_rate_factor, render.ffmpeg.gopsize = "PERC_LOSSLESS", fps
    render.filepath, render.use_file_extension = str(film), False
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.scenes.remove(scene)
    return film
