# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches on disk → the artist's object: Mesh Sequence Cache modifiers that bring attributes onto its own mesh.

Caches over λ (the field, and its Morse sets where they are baked) follow `obj.stormfield.lam` through a driver, the
frame cache follows the scene's frame; renders need no Python.
"""

from collections.abc import Callable, Collection, Mapping
from pathlib import Path

import bpy

from ...bake.task import TargetName
from ...cache.layout import PRIM, STAGE, TIME_CODES_PER_LAMBDA
from ..read.attached import FRAMES, LAMBDA, MORSE, NAMES, TURN
from . import mesh_edits, turning
from .cache_folders import delete_old_caches


def show_solved(obj: bpy.types.Object, folder: Path, keep: Collection[Path] = ()) -> None:
    """Attach a λ cache, and delete old ones but those to `keep`."""
    attach_lambda(obj, folder)
    delete_old_caches(folder.parent, "lambda", keep)


def show_baked(obj: bpy.types.Object, folders: Mapping[TargetName, Path], keep: Collection[Path] = ()) -> None:
    """Attach those baked caches that Blender shows on the mesh, and delete old ones but those to `keep`.

    folders: by target of the bake.
    """
    shown: tuple[tuple[TargetName, Callable[[bpy.types.Object, Path], None], str], ...] = (
        ("usd", attach_frames, "frames"),
        ("morse", attach_morse, "morse"),
    )
    for target, attach, word in shown:
        if target in folders:
            attach(obj, folders[target])
            delete_old_caches(folders[target].parent, word, keep)


def attach_lambda(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_orientation, sf_advection, sf_speed and sf_stream at the current λ onto the mesh."""
    _follow_lambda(obj, _attach(obj, LAMBDA, folder))
    turning.follow_surface(obj)


def attach_morse(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_morse and sf_morse_kind at the current λ onto the faces."""
    _follow_lambda(obj, _attach(obj, MORSE, folder))


def attach_frames(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_phase_a, sf_phase_b and sf_blend of the scene's frame onto the mesh."""
    _attach(obj, FRAMES, folder)
    obj.update_tag()


def _follow_lambda(obj: bpy.types.Object, cache_file: bpy.types.CacheFile) -> None:
    cache_file.override_frame = True
    cache_file.driver_remove("frame")
    driver = cache_file.driver_add("frame").driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.name = "lam"
    variable.targets[0].id = obj
    variable.targets[0].data_path = "stormfield.lam"
    driver.expression = f"lam * {TIME_CODES_PER_LAMBDA:.0f}"
    obj.update_tag()


def detach(obj: bpy.types.Object, names: tuple[str, ...] = NAMES) -> None:
    turn = obj.modifiers.get(TURN)
    if LAMBDA in names and turn is not None:
        obj.modifiers.remove(turn)
    for name in names:
        modifier = obj.modifiers.get(name)
        if modifier is not None:
            cache_file = modifier.cache_file
            obj.modifiers.remove(modifier)
            if cache_file is not None and cache_file.users == 0:
                bpy.data.batch_remove([cache_file])


def _attach(obj: bpy.types.Object, name: str, folder: Path) -> bpy.types.CacheFile:
    modifier = obj.modifiers.get(name)
    if modifier is None:
        modifier = obj.modifiers.new(name, "MESH_SEQUENCE_CACHE")
    path = _blend_path(folder / STAGE)
    if modifier.cache_file is None:
        modifier.cache_file = _open(folder / STAGE)
    modifier.cache_file.filepath = path
    modifier.object_path = PRIM
    modifier.read_data = {"ATTRIBUTES"}
    earlier = NAMES[: NAMES.index(name)]
    obj.modifiers.move(obj.modifiers.find(name), sum(other in obj.modifiers for other in earlier))
    mesh_edits.remember_attached(obj, modifier, folder)
    return modifier.cache_file


def _open(stage: Path) -> bpy.types.CacheFile:
    before = set(bpy.data.cache_files)
    bpy.ops.cachefile.open(filepath=str(stage), relative_path=False)
    cache_file = next(iter(set(bpy.data.cache_files) - before))
    cache_file.user_clear()  # the operator counts a button as user that is not there without a window
    return cache_file


def _blend_path(stage: Path) -> str:
    """Relative to the .blend file where there is one on the same drive."""
    blend = bpy.data.filepath
    return bpy.path.relpath(str(stage)) if blend and Path(blend).drive == stage.drive else str(stage)
