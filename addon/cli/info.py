# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield info FIELD: what the mesh is, which arrays are the field, and what else there is to choose; of a .blend
file, which caches its fields show and which are baked for them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from ..readers import Choice
from .blender import load_core
from .group import cli
from .output import Phases, describe_mesh, field_argument, surface_of, write_json, write_result
from .scene_file import fields_of, open_scene

if TYPE_CHECKING:
    from bpy.types import Context, Object

    from ..model.words import Json


#: Caches that a mesh shows, by the words of the command line.
SHOWN = ("solved", "usd", "morse")


@cli.command()
@field_argument
@click.option("--json", "out", default="-", show_default=True, help="File to write; - is standard output.")
@click.pass_obj
def info(register: Callable[[], None] | None, field: str, choice: Choice, out: str) -> None:
    """Describe the mesh of FIELD, what of it is the field and at which λ, and what else there is to choose. Of a .blend
    file: the caches that its fields show, and those that are baked for their settings."""
    if Path(field).suffix.lower() == ".blend":
        _describe_scene(field, register, out)
        return
    from ..readers import NoFieldError, read_field, read_mesh

    phases = Phases()
    load_core()
    with phases("read"):
        try:
            data = read_field(field, choice)
            surface, lambdas, read = data.mesh, data.lambdas, data.read
        except NoFieldError:  # a mesh alone is worth describing too
            (surface, read), lambdas = read_mesh(field), np.zeros(0)
    with phases("mesh"):
        mesh = surface_of(surface, field)
    write_result(
        out,
        "stormfield.info/1",
        read,
        {
            "mesh": describe_mesh(mesh),
            "lam": [float(lam) for lam in lambdas],
            "seconds": phases.seconds,
        },
    )


def _describe_scene(scene: str, register: Callable[[], None] | None, out: str) -> None:
    bpy, path = open_scene(scene, register)
    fields = [_describe_field(bpy.context, obj) for obj in fields_of(bpy, path)]
    write_json(out, {"schema": "stormfield.scene_info/1", "scene": str(path), "fields": fields})


def _describe_field(context: Context, obj: Object) -> dict[str, Json]:
    from ..scene.read.attached import attached_folder
    from ..scene.read.finished_caches import WORDS, not_shown, read_finished

    found = read_finished(context, obj)
    words = not_shown(obj, found)
    if words:
        print(
            f"'{obj.name}': baked for its settings, and not shown yet: {', '.join(words)}; press Use Baked Caches, "
            "or run bake --resume --save",
            file=sys.stderr,
        )
    shown = {name: attached_folder(obj, modifier) for name, modifier in zip(SHOWN, WORDS, strict=True)}
    baked = [("solved", found.solved), *found.targets.items()]
    return {"object": obj.name, "shown": _texts(shown.items()), "baked": _texts(baked)}


def _texts(folders: Iterable[tuple[str, Path | None]]) -> dict[str, Json]:
    return {name: str(folder) for name, folder in folders if folder is not None}
