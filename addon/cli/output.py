# SPDX-License-Identifier: GPL-3.0-or-later
"""What every command shares: options, the description of a mesh, seconds by phase, JSON out."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from .. import native
from ..model.errors import InputError
from ..model.words import Json


def field_argument(command: Callable) -> Callable:
    """FIELD and the options of its readers."""
    command = click.option("--sphere-faces", type=int, help="Faces of the sphere that carries wind, about.")(command)
    command = click.option("--vector", help="Point data that is the field: NAME, or X,Y,Z.")(command)
    return click.argument("field", type=click.Path())(command)


class Phases:
    """Seconds by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        began = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - began


def describe_mesh(mesh: native.TriangleMesh) -> dict[str, int]:
    """A native mesh in the words of the command line."""
    return {
        "vertices": mesh.vertex_count,
        "faces": mesh.face_count,
        "components": mesh.component_count,
        "boundary_loops": mesh.boundary_loop_count,
        "euler_characteristic": mesh.euler_characteristic,
    }


def write_json(target: str, content: dict[str, Json]) -> None:
    """To a file, whole or not at all, or with - to standard output."""
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if target == "-":
        sys.stdout.write(text)
        return
    path = Path(target)
    temporary = path.with_name(path.name + ".tmp")
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another place") from error
