# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield bake SCENE.blend: the scene's bakes, as the add-on's own buttons would run them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import click

from ..model.errors import InputError
from .blender import quiet
from .group import cli
from .progress import progress

if TYPE_CHECKING:
    from bpy.types import Object

    from ..bake.task import TargetName


@cli.command()
@click.argument("scene", type=click.Path())
@click.option("--targets", default="usd", show_default=True, help="Comma separated: usd, exr, vdb, morse.")
@click.option("--frames", help="A-B: those of the scene's frames to write here, for one machine of many.")
@click.option("--resume", is_flag=True, help="Keep finished samples and frames.")
@click.option("--solve-only", is_flag=True, help="Write the λ caches and nothing else.")
@click.option("--save", is_flag=True, help="Save the scene with the caches attached.")
def bake(scene: str, targets: str, frames: str | None, resume: bool, solve_only: bool, save: bool) -> None:
    """Solve and bake every field of SCENE.blend."""
    wanted = frozenset() if solve_only else _targets(targets)
    only = _frames(frames)
    path = Path(scene)
    if not path.is_file():
        raise InputError(f"{path}: no such file; check the name")
    bpy = _blender()
    _open(bpy, path)
    objects = [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.stormfield.enabled]
    if not objects:
        raise InputError(f"{path}: no object has a Stormfield field; add one in Blender's sidebar, tab Stormfield")
    for obj in objects:
        _bake(bpy, obj, wanted, only, resume)
    if save:
        with quiet():
            bpy.ops.wm.save_mainfile()


def _bake(
    bpy: ModuleType, obj: Object, targets: frozenset[TargetName], only: frozenset[int] | None, resume: bool
) -> None:
    from ..bake.job import bake_steps, check_task
    from ..bake.lambda_cache import solve_steps
    from ..scene.read import folders
    from ..scene.read.bake_task import read_bake_task
    from ..scene.read.design import read_design
    from ..scene.read.mesh import read_polygons
    from ..scene.write import attach
    from ..work import run

    saved = folders.shown_folders()  # which the scene on disk shows, unless it is saved again
    task = replace(read_bake_task(bpy.context, obj, Path()), targets=targets, only=only, resume=resume)
    check_task(task)
    mesh, design = read_design(bpy.context, obj)
    with progress(f"Solving '{obj.name}'") as show:
        folder = run(solve_steps(mesh, design, folders.cache_root(obj), read_polygons(obj)), show)
    attach.show_solved(obj, folder, saved)
    if not targets:
        return
    with progress(f"Baking '{obj.name}'") as show:
        result = run(bake_steps(replace(task, cache=folder)), show)
    if result.whole:
        attach.show_baked(obj, result.folders, saved)
    for target, written in result.folders.items():
        click.echo(f"{obj.name}\t{target}\t{written}")
    for remark in result.remarks:
        click.echo(f"note: {remark}", err=True)


def _targets(text: str) -> frozenset[TargetName]:
    from ..bake.targets import TARGETS

    names = {name.strip() for name in text.split(",") if name.strip()}
    unknown = sorted(names - set(TARGETS))
    if unknown or not names:
        wrong = unknown[0] if unknown else "nothing"
        raise InputError(f"--targets {text!r}: {wrong}; choose from {', '.join(TARGETS)}")
    return frozenset(target for target in TARGETS if target in names)


def _frames(text: str | None) -> frozenset[int] | None:
    if text is None:
        return None
    match = re.fullmatch(r"(-?\d+)(?:-(-?\d+))?", text.strip())
    if match is None:
        raise InputError(f"--frames {text!r}: give A-B, such as 1-120")
    first = int(match[1])
    last = first if match[2] is None else int(match[2])
    if last < first:
        raise InputError(f"--frames {text!r}: ends before it starts; exchange the two")
    return frozenset(range(first, last + 1))


def _blender() -> ModuleType:
    try:
        with quiet():
            import bpy
    except ImportError as error:
        raise InputError(
            f".blend files need Blender ({error}); pip install bpy, or run blender --background"
        ) from error
    return bpy


def _open(bpy: ModuleType, path: Path) -> None:
    from .. import register

    if not hasattr(bpy.types.Object, "stormfield"):
        register()
    try:
        with quiet():
            bpy.ops.wm.open_mainfile(filepath=str(path.resolve()))
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
        raise InputError(f"{path}: Blender cannot open it ({reason})") from error
