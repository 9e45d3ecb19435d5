# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield edit FIELD EDITS.json --out DIR: FIELD with edits → a λ cache, and a report for each edit."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from ..model.errors import InputError
from ..readers import Choice
from .blender import load_core
from .group import cli
from .json_file import read_json
from .output import Phases, describe_mesh, field_argument, surface_of, write_result
from .progress import progress

if TYPE_CHECKING:
    from ..model.edits import Edit


@cli.command()
@field_argument
@click.argument("edits", type=click.Path())
@click.option("--out", required=True, type=click.Path(), help="Folder of the cache.")
@click.option("--json", "report", help="File for a report; - is standard output.")
def edit(field: str, edits: str, choice: Choice, out: str, report: str | None) -> None:
    """Apply EDITS to FIELD, in order: cancel, move, smooth, simplify. Each is verified by the analysis of the field, or
    refused and changes nothing; the report says which, and why."""
    from .. import native
    from ..bake.given import GivenField, given_steps
    from ..edits import edit_steps, notes_of, to_json
    from ..readers import read_series
    from ..work import run

    phases = Phases()
    chosen = read_edits(Path(edits))
    load_core()
    with phases("read"):
        data = read_series(field, choice)
    with phases("mesh"):
        mesh = surface_of(data.mesh, field)
    given = np.array([np.asarray(vectors, np.float64) for vectors in data.vectors])
    tangents = np.stack([native.VectorField.from_space(mesh, vectors).values for vectors in given])
    whole = native.ParameterizedField(mesh, np.asarray(data.lambdas, np.float64), tangents)
    with phases("edit"), progress("Editing") as show:
        edited = run(edit_steps(whole, chosen), show)
    for note in notes_of(edited.reports):
        print(f"note: {note}", file=sys.stderr)
    changed = np.asarray(edited.field.values) != tangents
    for j, vectors in enumerate(given):
        vectors[changed[j]] = edited.field.sample(j).to_space()[changed[j]]
    origin = {"read": data.read.to_json(), "edits": [each.to_json() for each in chosen]}
    made = GivenField(tuple(data.lambdas.tolist()), given, origin)
    with phases("write"), progress("Writing") as show:
        folder = run(given_steps(data.mesh, made, Path(out), folder=Path(out)), show)
    content = {
        "mesh": describe_mesh(mesh),
        "lam": data.lambdas.tolist(),
        "cache": str(folder),
        "edits": to_json(edited.reports),
        "seconds": phases.seconds,
    }
    if report:
        write_result(report, "stormfield.edit/1", data.read, content)
    else:
        print(f"read: {data.read.line()}", file=sys.stderr)


def read_edits(path: Path) -> tuple[Edit, ...]:
    """The edits of a JSON file. Raises InputError."""
    from ..model.edits import edits_from_json

    data = read_json(path)
    try:
        return edits_from_json(data)
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
