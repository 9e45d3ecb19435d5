# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches on disk → the artist's object: Mesh Sequence Cache modifiers that bring attributes onto its own mesh.

Caches over λ (the field, and its Morse sets where they are baked) follow `obj.stormfield.lam` through a driver, the
frame cache follows the scene's frame; renders need no Python. Each object has cache files of its own: one that it
shares, as a copied object does, is left to the other.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

import bpy

from ...bake.task import TargetName
from ...cache.layout import PRIM, STAGE
from ..read.attached import FRAMES, LAMBDA, MORSE, NAMES, OVER_LAMBDA, SCENE, SORT, TURN, find_modifier, modifiers_of
from ..read.cache_paths import RECORDS, cache_paths
from ..read.folders import cache_root, relative
from . import cache_files, mesh_edits, turning
from .scene_flows import drivers_of, flow_of, number_of, show_in_its_scene


def show_solved(obj: bpy.types.Object, folder: Path) -> None:
    """Attach a λ cache."""
    attach_lambda(obj, folder)
    if folder.parent == cache_root(obj):
        obj.stormfield.cache_name = folder.parent.name


def show_baked(obj: bpy.types.Object, folders: Mapping[TargetName, Path]) -> None:
    """Attach those baked caches that Blender shows on the mesh; lead what shows the last flow maps and volumes of this
    object to the new ones. folders: by target of the bake."""
    shown: tuple[tuple[TargetName, Callable[[bpy.types.Object, Path], None]], ...] = (
        ("usd", attach_frames),
        ("morse", attach_morse),
    )
    for target, attach in shown:
        if target in folders:
            attach(obj, folders[target])
    for target, name in RECORDS.items():
        if target in folders:
            _lead_to(obj, name, folders[target])


def attach_lambda(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_orientation, sf_advection, sf_speed and sf_stream at the current λ onto the mesh."""
    _attach(obj, LAMBDA, folder)
    turning.follow_surface(obj)


def attach_morse(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_morse and sf_morse_kind at the current λ onto the faces."""
    _attach(obj, MORSE, folder)


def attach_frames(obj: bpy.types.Object, folder: Path) -> None:
    """Bring sf_phase_a, sf_phase_b and sf_blend of the scene's frame onto the mesh."""
    _attach(obj, FRAMES, folder)


def detach(obj: bpy.types.Object, names: tuple[str, ...] = NAMES) -> None:
    turn = find_modifier(obj, TURN)
    if LAMBDA in names and turn is not None:
        obj.modifiers.remove(turn)
    for name in names:
        for modifier in modifiers_of(obj, name):
            for curve in list(drivers_of(obj, modifier)):
                obj.animation_data.drivers.remove(curve)
            cache_file = modifier.cache_file
            obj.modifiers.remove(modifier)
            if cache_file is not None and cache_file.users == 0:
                bpy.data.batch_remove([cache_file])


def _attach(obj: bpy.types.Object, sort: str, folder: Path) -> None:
    modifier = flow_of(obj, bpy.context.scene) if sort == FRAMES else find_modifier(obj, sort)
    if modifier is None:
        modifier = obj.modifiers.new(sort, "MESH_SEQUENCE_CACHE")
    stage = folder / STAGE
    cache_file = modifier.cache_file
    if cache_file is None or not cache_files.is_own(obj, cache_file):
        modifier.cache_file = cache_file = cache_files.new(stage)
    cache_file[SORT] = sort
    cache_files.set_path(cache_file, stage)
    modifier.object_path = PRIM
    modifier.read_data = {"ATTRIBUTES"}
    earlier = sum(len(modifiers_of(obj, other)) for other in NAMES[: NAMES.index(sort)])
    earlier += modifiers_of(obj, sort).index(modifier)
    if obj.modifiers[earlier] != modifier:
        obj.modifiers.move(list(obj.modifiers).index(modifier), earlier)
    if sort in OVER_LAMBDA:
        cache_files.follow_lambda(obj, cache_file)
    else:
        cache_files.follow_frames(cache_file, bpy.context.scene)
        cache_file[SCENE] = number_of(bpy.context.scene)
        show_in_its_scene(obj)
    mesh_edits.remember_attached(obj, modifier, folder)
    obj.update_tag()


def _lead_to(obj: bpy.types.Object, name: str, folder: Path) -> None:
    """Images and volumes that show files of the recorded cache show those of the new one."""
    found = list(cache_paths())
    old = next((path.folder for path in found if path.block == obj and path.name == name), None)
    others = {path.folder for path in found if path.is_record and path.block != obj}
    for path in found:
        if path.folder == old and old not in others and not path.is_record:
            path.write(relative(path.inside(folder), bpy.data.filepath))
    setattr(obj.stormfield.bake, name, relative(folder, bpy.data.filepath))
