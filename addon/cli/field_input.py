# SPDX-License-Identifier: GPL-3.0-or-later
"""The opening that analyze, morse and track share: FIELD is read, its mesh made; and how they end: picture and JSON.

@cli.command()
@field_command("Picture of the field.")
def analyze(given: FieldInput, ...): ...; given.draw(draw_analysis, ...); given.write("stormfield.x/1", {...})
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from dataclasses import replace

import click

from ..model.errors import InputError
from ..model.words import Json
from ..readers import Choice, FieldData, Reading, read_field
from .blender import load_core
from .located import located
from .output import Phases, describe_mesh, field_argument, surface_of, write_result

Read = Callable[[str, Choice], FieldData]


class FieldInput:
    """FIELD as its command gets it. Raises InputError before anything long begins where the picture cannot be made."""

    def __init__(self, field: str, read: Read, choice: Choice, out: str, image: str | None) -> None:
        from ..figures.image import check as check_image

        if image is not None:
            check_image(image)
        self.name, self.choice, self.phases = field, choice, Phases()
        self._out, self._image = out, image
        load_core()
        with self.phases("read"):
            self.data = read(field, choice)
        with self.phases("mesh"):
            self.mesh = surface_of(self.data.mesh, field)
        turned = {"faces turned as their neighbours are": self.mesh.flipped_face_count}
        self.read = replace(self.data.read, changes={**self.data.read.changes, **turned})

    def note(self, text: str) -> None:
        """What the user should know although nothing is wrong, on standard error; nothing where it is empty."""
        if text:
            print(f"note: {text}", file=sys.stderr)

    def draw(self, draw: Callable[..., None], *arguments: object) -> None:
        """draw(image, mesh, *arguments) where a picture is asked for."""
        if self._image is not None:
            with self.phases("image"):
                draw(self._image, self.mesh, *arguments)

    def write(self, schema: str, content: dict[str, Json], seconds: dict[str, float] | None = None) -> dict[str, Json]:
        """The JSON, with what all commands write. Returns `content` as it is written."""
        spent = self.phases.seconds | (seconds or {})
        if self.data.geography is not None:
            content = located(content, self.data.geography)
        write_result(self._out, schema, self.read, {"mesh": describe_mesh(self.mesh), **content, "seconds": spent})
        return content

    def write_part(self, schema: str, read: Reading, content: dict[str, Json]) -> None:
        """The JSON of a part of the samples, with what places and times of the whole need."""
        places = self.data.geography.to_json() if self.data.geography is not None else None
        about = {"mesh": describe_mesh(self.mesh), "geography": places}
        read = replace(read, changes=self.read.changes)
        write_result(self._out, schema, read, {**about, **content, "seconds": self.phases.seconds})


def field_command(picture: str, read: Read = read_field) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """FIELD, which `read` reads, the options that choose of it, --json and --image, which shows `picture`. The command
    gets one FieldInput for them, and its own options."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(command)
        def opened(field: str, choice: Choice, out: str, image: str | None, **options: object) -> None:
            command(FieldInput(field, read, choice, out, image), **options)

        for option in (
            click.option("--image", help=f"{picture}: .png, .pdf or .svg."),
            click.option("--json", "out", required=True, help="File to write; - is standard output."),
        ):
            opened = option(opened)
        return field_argument(opened)

    return decorate


def lam_option(command: Callable[..., None]) -> Callable[..., None]:
    """--lam, checked before anything is read."""
    return click.option(
        "--lam", type=float, callback=_checked, help="λ of the instantaneous field, 0..1.  [default: the first sample]"
    )(command)


def _checked(_context: click.Context, _parameter: click.Parameter, lam: float | None) -> float | None:
    if lam is not None and not 0.0 <= lam <= 1.0:
        raise InputError(f"--lam {lam:g} is outside 0..1; λ runs from 0 to 1")
    return lam
