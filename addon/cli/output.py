# SPDX-License-Identifier: GPL-3.0-or-later
"""What every command shares: options, the description of a mesh, seconds by phase, JSON out."""

from __future__ import annotations

import functools
import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from .. import native
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.words import Json
from ..readers import EARTH_RADIUS_KM, Choice, Reading

#: The options that become a Choice.
CHOICES = ("vector", "sphere_faces", "attribute", "level", "member", "at", "times", "radius_km")


def field_argument(command: Callable[..., None]) -> Callable[..., None]:
    """FIELD, and the options that say what of it is read. The command gets them as field and choice."""

    @functools.wraps(command)
    def chosen(**options: object) -> None:
        given = {name: options.pop(name) for name in CHOICES}
        command(choice=Choice(**given), **options)  # type: ignore[arg-type]

    for option in (
        click.option(
            "--radius",
            "radius_km",
            type=float,
            default=EARTH_RADIUS_KM,
            show_default=True,
            help="Radius of the sphere of a grid, kilometres.",
        ),
        click.option("--times", nargs=2, metavar="A B", help="First and last time of a grid: dates, or its numbers."),
        click.option(
            "--at", multiple=True, metavar="NAME=VALUE", callback=_pairs, help="Value of any other dimension of a grid."
        ),
        click.option("--member", help="Member of an ensemble on a grid."),
        click.option("--level", help="Level of a grid, such as 850, in its own unit."),
        click.option("--attribute", default="sf_advection", show_default=True, help="Vector attribute of a cache."),
        click.option(
            "--sphere-faces",
            metavar="N",
            default="auto",
            show_default=True,
            callback=_faces,
            help="Faces of the sphere that carries a grid of the whole globe, about; auto follows the grid.",
        ),
        click.option(
            "--vector",
            help="Array that is the field: NAME, or X,Y,Z; points:NAME or cells:NAME where both have it. "
            "stormfield info lists them.",
        ),
    ):
        chosen = option(chosen)
    return click.argument("field", nargs=-1, required=True, metavar="FIELD", callback=_one_field)(chosen)


def _one_field(_context: click.Context, _parameter: click.Parameter, given: tuple[str, ...]) -> str:
    """The shell replaces a pattern without quotes by the names that fit."""
    if len(given) > 1:
        raise InputError(
            f"{given[0]} and {len(given) - 1} more names: give one FIELD; put a pattern in quotes, or give the folder"
        )
    return given[0]


def _faces(_context: click.Context, _parameter: click.Parameter, given: str) -> int | None:
    if given == "auto":
        return None
    try:
        return int(given)
    except ValueError:
        raise InputError(f"--sphere-faces {given} is no number; give one, or auto") from None


def _pairs(_context: click.Context, _parameter: click.Parameter, given: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    pairs = tuple(tuple(part.strip() for part in word.split("=", 1)) for word in given)
    wrong = next((word for word, pair in zip(given, pairs, strict=True) if len(pair) != 2), None)
    if wrong is not None:
        raise InputError(f"--at {wrong}: write NAME=VALUE, such as --at depth=0.5")
    return pairs  # type: ignore[return-value]


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


def surface_of(data: MeshData, name: str) -> native.TriangleMesh:
    """The native mesh. Raises InputError that names the file beside the element."""
    try:
        return native.TriangleMesh(data.vertices, data.triangles)
    except InputError as fault:
        raise InputError(f"{name}: {fault}") from fault


def describe_mesh(mesh: native.TriangleMesh) -> dict[str, int]:
    """A native mesh in the words of the command line."""
    return {
        "vertices": mesh.vertex_count,
        "faces": mesh.face_count,
        "components": mesh.component_count,
        "boundary_loops": mesh.boundary_loop_count,
        "euler_characteristic": mesh.euler_characteristic,
    }


def write_result(target: str, schema: str, read: Reading, content: dict[str, Json]) -> None:
    """The JSON of a command, and on standard error the line that says what was read."""
    write_json(target, {"schema": schema, "read": read.to_json(), **content})
    print(f"read: {read.line()}", file=sys.stderr)


def write_json(target: str, content: dict[str, Json]) -> None:
    """To a file, whole or not at all, or with - to standard output."""
    text = json_text(content)
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


def json_text(content: dict[str, Json]) -> str:
    """One line for each key, and for each entry of a list of objects: as many lines as there are paths, not numbers."""
    dumps = functools.partial(json.dumps, ensure_ascii=False, allow_nan=False)

    def value(of: Json) -> str:
        if isinstance(of, list) and of and isinstance(of[0], dict):
            return "[\n  " + ",\n  ".join(map(dumps, of)) + "\n ]"
        return dumps(of)

    return "{\n " + ",\n ".join(f"{dumps(key)}: {value(of)}" for key, of in content.items()) + "\n}\n"
