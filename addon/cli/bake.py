# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield bake SCENE.blend: the scene's bakes, as the add-on's own buttons would run them."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import click

from ..model.errors import InputError
from .blender import quiet
from .faults import UnfinishedError
from .group import cli
from .progress import progress
from .scene_file import fields_of, open_scene

if TYPE_CHECKING:  # not when --help is asked for: they bring NumPy along
    from bpy.types import Object

    from ..bake.task import BakeResult, BakeTask, TargetName
    from ..model.design import Design
    from ..model.mesh_data import MeshData


#: Seconds to wait for names that other machines wrote, and between two looks.
APPEAR, LOOK_AGAIN = 90.0, 1.0


@dataclass(frozen=True)
class Chunk:
    """What one machine of many does of a bake."""

    frames: frozenset[int] | None  #: None: all
    resume: bool = False
    join: bool = False  #: writes no frame, but what joins those of the others
    verify: bool = False


@cli.command()
@click.argument("scene", type=click.Path(), required=False)
@click.option("--targets", default="usd", show_default=True, help="Comma separated: usd, exr, vdb, morse.")
@click.option("--frames", help="A-B: those of the scene's frames to write here, for one machine of many.")
@click.option("--resume", is_flag=True, help="Keep finished samples and frames.")
@click.option("--solve-only", is_flag=True, help="Write the λ caches and nothing else.")
@click.option("--join", is_flag=True, help="Write no frame: wait for those of other machines, then the manifests.")
@click.option("--verify", is_flag=True, help="Read every file before a manifest vouches for it.")
@click.option("--save", is_flag=True, help="Save the scene with the caches attached.")
@click.pass_obj
def bake(
    register: Callable[[], None] | None,
    scene: str | None,
    targets: str,
    frames: str | None,
    resume: bool,
    solve_only: bool,
    join: bool,
    verify: bool,
    save: bool,
) -> None:
    """Solve and bake every field of SCENE.blend; inside Blender, of the file that is open where none is named."""
    wanted = frozenset() if solve_only else _targets(targets)
    chunk = Chunk(_frames(frames), resume, join, verify)
    bpy, path = open_scene(scene, register)
    objects = fields_of(bpy, path)
    for obj in objects:
        _bake(bpy, obj, wanted, chunk)
    if save:
        with quiet():
            bpy.ops.wm.save_mainfile()


def _bake(bpy: ModuleType, obj: Object, wanted: frozenset[TargetName], chunk: Chunk) -> None:
    from ..bake.job import check_task
    from ..scene.read.bake_task import read_bake_task
    from ..scene.read.current_field import base_folder
    from ..scene.read.design import read_design
    from ..scene.read.lambda_source import why_sampled
    from ..scene.write import attach

    task = replace(
        read_bake_task(bpy.context, obj, Path()),
        targets=wanted,
        only=chunk.frames,
        resume=chunk.resume,
        verify=chunk.verify,
    )
    check_task(task)
    why = why_sampled(obj)
    if why:
        click.echo(f"note: λ of '{obj.name}' comes from {why}; it was read at each frame", err=True)
    folder = base_folder(obj)
    if folder is None:
        mesh, design = read_design(bpy.context, obj)
        folder = _joined_field(obj, mesh, design) if chunk.join else _solved_field(obj, mesh, design)
        attach.show_solved(obj, folder)
    if not wanted:
        return
    task = replace(task, cache=folder)
    result = _joined(obj, task) if chunk.join else _baked(obj, task)
    if result.whole:
        attach.show_baked(obj, result.folders)
    for target, written in result.folders.items():
        click.echo(f"{obj.name}\t{target}\t{written}")
    for remark in result.remarks:
        click.echo(f"note: {remark}", err=True)


def _solved_field(obj: Object, mesh: MeshData, design: Design) -> Path:
    from ..bake.lambda_cache import solve_steps
    from ..scene.read.folders import cache_root
    from ..scene.read.mesh import read_polygons
    from ..work import run

    with progress(f"Solving '{obj.name}'") as show:
        return run(solve_steps(mesh, design, cache_root(obj), read_polygons(obj)), show)


def _baked(obj: Object, task: BakeTask) -> BakeResult:
    from ..bake.job import bake_steps
    from ..work import run

    with progress(f"Baking '{obj.name}'") as show:
        return run(bake_steps(task), show)


# Joining what other machines wrote --------------------------------------------------------------------------------


def _joined_field(obj: Object, mesh: MeshData, design: Design) -> Path:
    """The finished λ cache, which may appear late on a network folder. Raises UnfinishedError."""
    from ..bake.lambda_cache import lambda_plan
    from ..cache.layout import MANIFEST
    from ..scene.read.folders import cache_root

    folder = cache_root(obj) / lambda_plan(mesh, design).folder_name("lambda")
    if not _wait(lambda: (folder / MANIFEST).is_file()):
        raise UnfinishedError(f"{folder}: the field is not solved; run bake --solve-only before the join")
    return folder


def _joined(obj: Object, task: BakeTask) -> BakeResult:
    """The bake once all its frames are there. Raises UnfinishedError naming those that do not appear."""
    results: list[BakeResult] = []

    def whole() -> bool:
        results[:] = [_baked(obj, replace(task, only=frozenset(), resume=True))]
        return results[0].whole

    if not _wait(whole):
        absent = results[0].absent
        shown = ", ".join(absent[:5]) + (f" and {len(absent) - 5} more" if len(absent) > 5 else "")
        raise UnfinishedError(f"{len(absent)} files are not written: {shown}; bake these frames, then join again")
    return results[0]


def _wait(done: Callable[[], bool]) -> bool:
    """Asks until it is done: names that other machines wrote take up to a minute to appear on network folders."""
    end = time.monotonic() + APPEAR
    while not done():
        if time.monotonic() >= end:
            return False
        time.sleep(LOOK_AGAIN)
    return True


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
