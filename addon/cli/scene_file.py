# SPDX-License-Identifier: GPL-3.0-or-later
"""A .blend file as a command gets it: by Blender, with the add-on registered."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from ..model.errors import InputError
from .blender import quiet

if TYPE_CHECKING:
    from bpy.types import Object


def open_scene(scene: str | None, register: Callable[[], None] | None) -> tuple[ModuleType, Path]:
    """Blender with the scene open and the add-on registered, and the scene's file."""
    if scene is not None and not Path(scene).is_file():
        raise InputError(f"{scene}: no such file; check the name")
    bpy = _blender()
    if not hasattr(bpy.types.Object, "stormfield"):
        if register is None:
            raise InputError("the extension is not enabled in this Blender; enable Stormfield in its preferences")
        register()
    if scene is not None:
        _open(bpy, Path(scene))
    elif not bpy.data.filepath:
        raise InputError(
            "no scene is given; name a .blend file, or open one: blender -b SCENE.blend --command stormfield …"
        )
    return bpy, Path(bpy.data.filepath)


def fields_of(bpy: ModuleType, path: Path) -> list[Object]:
    """The objects of the scene that have a field. Raises InputError where none has."""
    objects = [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.stormfield.enabled]
    if not objects:
        raise InputError(f"{path}: no object has a Stormfield field; add one in Blender's sidebar, tab Stormfield")
    return objects


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
    try:
        with quiet():
            bpy.ops.wm.open_mainfile(filepath=str(path.resolve()))
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
        raise InputError(f"{path}: Blender cannot open it ({reason})") from error
