# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield import FIELD --out DIR: FIELD → a λ cache, which Blender imports without more packages."""

from __future__ import annotations

import sys
from pathlib import Path

import click
import numpy as np

from ..model.errors import InputError
from ..readers import Choice
from .blender import load_core
from .group import cli
from .output import Phases, describe_mesh, field_argument, surface_of, write_result
from .progress import progress


@cli.command("import")
@field_argument
@click.option("--out", required=True, type=click.Path(), help="Folder of the cache.")
@click.option("--globe", type=float, default=1.0, show_default=True, help="Radius that a globe gets, mesh units.")
@click.option(
    "--seconds", type=float, default=10.0, show_default=True, help="Time that the data of a globe take in the scene."
)
@click.option("--json", "report", help="File for a report; - is standard output.")
def import_(field: str, choice: Choice, out: str, globe: float, seconds: float, report: str | None) -> None:
    """Make a λ cache of FIELD. Blender opens it by File > Import > Stormfield Data."""
    from ..bake.given import GivenField, given_steps
    from ..model.mesh_data import MeshData
    from ..readers import SceneScale, read_series
    from ..work import run

    for name, value in (("--globe", globe), ("--seconds", seconds)):
        if not 0.0 < value < np.inf:
            raise InputError(f"{name} {value:g} is out of range; choose a number above 0")
    phases = Phases()
    load_core()
    with phases("read"):
        data = read_series(field, choice)
    scale = SceneScale.of(data, globe, seconds)
    # In the precision of Blender's meshes, so that the cache fits the mesh that is made from it.
    mesh = MeshData((scale.lengths * data.mesh.vertices).astype(np.float32), data.mesh.triangles)
    origin = {"read": data.read.to_json(), "scale": [scale.lengths, scale.speeds]}
    given = GivenField(tuple(data.lambdas.tolist()), (scale.speeds * values for values in data.vectors), origin)
    with phases("write"), progress("Importing") as show:
        folder = run(given_steps(mesh, given, Path(out), folder=Path(out)), show)
    content = {
        "mesh": describe_mesh(surface_of(mesh, field)),
        "lam": data.lambdas.tolist(),
        "cache": str(folder),
        "scale": {"lengths": scale.lengths, "speeds": scale.speeds, "words": scale.words},
        "seconds": phases.seconds,
    }
    if report:
        write_result(report, "stormfield.import/1", data.read, content)
    else:
        print(f"read: {data.read.line()}", file=sys.stderr)
