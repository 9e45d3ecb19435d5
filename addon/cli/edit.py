# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield edit FIELD EDITS.json --out DIR: FIELD with edits → a λ cache, and a report for each edit."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from .. import native
from ..cache.fields import ATTRIBUTE
from ..model.design import FieldName
from ..model.errors import InputError
from ..readers import Choice, FieldData, read_series
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
    """Apply EDITS to FIELD, in order: cancel, move, smooth, simplify, transform, remove_bifurcation, move_bifurcation.
    Each is verified by the analysis of the field, or refused and changes nothing; the report says which, and why. Of a
    cache both fields are edited, or with --attribute that one alone."""
    from ..bake.edited import edited_fields, report_json
    from ..bake.given import GivenField, given_steps
    from ..work import run

    phases = Phases()
    chosen = read_edits(Path(edits))
    load_core()
    with phases("read"):
        both = _fields(field, choice)
    data = both["advection"]
    with phases("mesh"):
        mesh = surface_of(data.mesh, field)
    alone = _chosen_alone(data, choice)
    acting = chosen if alone is None else [_on_one(each, alone) for each in chosen]
    given: dict[FieldName, _Given] = {"advection": _Given(mesh, data)}
    same = both["orientation"] is data
    given["orientation"] = given["advection"] if same else _Given(mesh, both["orientation"])
    with phases("edit"), progress("Editing") as show:
        edited = run(edited_fields({name: one.field for name, one in given.items()}, acting), show)
    for note in edited.notes:
        print(f"note: {note}", file=sys.stderr)
    origin = {"read": data.read.to_json(), "edits": [each.to_json() for each in chosen]}
    advection, orientation = (given[name].after(edited.fields[name]) for name in ("advection", "orientation"))
    made = GivenField(tuple(data.lambdas.tolist()), advection, origin, orientation)
    with phases("write"), progress("Writing") as show:
        folder = run(given_steps(data.mesh, made, Path(out), folder=Path(out)), show)
    content = {
        "mesh": describe_mesh(mesh),
        "lam": data.lambdas.tolist(),
        "cache": str(folder),
        "edits": [report_json(reports) for reports in edited.reports],
        "seconds": phases.seconds,
    }
    if report:
        write_result(report, "stormfield.edit/1", data.read, content)
    else:
        print(f"read: {data.read.line()}", file=sys.stderr)


def _fields(path: str, choice: Choice) -> dict[FieldName, FieldData]:
    """Those of a cache; of other data the one that it has, twice."""
    chosen = read_series(path, choice)
    if _is_one_of_two(chosen, choice):
        found = {name: read_series(path, replace(choice, attribute=its)) for name, its in ATTRIBUTE.items()}
        both = zip(found["orientation"].vectors, found["advection"].vectors, strict=True)
        if not all(np.array_equal(turns, moves) for turns, moves in both):
            return found
        chosen = found["advection"]
    return {"orientation": chosen, "advection": chosen}


def _is_one_of_two(data: FieldData, choice: Choice) -> bool:
    """Whether it comes from a cache that has orientation and advection."""
    names = {array.name for array in data.read.choices}
    return choice.attribute in ATTRIBUTE.values() and names.issuperset(ATTRIBUTE.values())


def _chosen_alone(data: FieldData, choice: Choice) -> FieldName | None:
    """The field of a cache that --attribute names, where a user has given it."""
    source = click.get_current_context().get_parameter_source("attribute")
    if source != click.core.ParameterSource.COMMANDLINE or not _is_one_of_two(data, choice):
        return None
    return next(name for name, its in ATTRIBUTE.items() if its == choice.attribute)


def _on_one(edit: Edit, name: FieldName) -> Edit:
    """The edit of one field alone; turned off where it is meant for the other."""
    return replace(edit, field=name, enabled=edit.enabled and edit.field in ("both", name))


class _Given:
    """Vectors in space over λ, and the field in the surface that they make."""

    def __init__(self, mesh: native.TriangleMesh, data: FieldData) -> None:
        self._vectors = np.array([np.asarray(vectors, np.float64) for vectors in data.vectors])
        self._tangents = np.stack([native.VectorField.from_space(mesh, each).values for each in self._vectors])
        self.field = native.ParameterizedField(mesh, np.asarray(data.lambdas, np.float64), self._tangents)

    def after(self, edited: native.ParameterizedField) -> np.ndarray:
        """The vectors, with those that an edit changed from it."""
        vectors, changed = self._vectors.copy(), np.asarray(edited.values) != self._tangents
        for j, now in enumerate(vectors):
            now[changed[j]] = edited.sample(j).to_space()[changed[j]]
        return vectors


def read_edits(path: Path) -> tuple[Edit, ...]:
    """The edits of a JSON file. Raises InputError."""
    from ..model.edits import edits_from_json

    data = read_json(path)
    try:
        return edits_from_json(data)
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
