# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield info FIELD: what the mesh is."""

import click
import numpy as np

from .blender import load_core
from .group import cli
from .output import Phases, describe_mesh, field_argument, write_json


@cli.command()
@field_argument
@click.option("--json", "out", default="-", show_default=True, help="File to write; - is standard output.")
def info(field: str, vector: str | None, sphere_faces: int | None, out: str) -> None:
    """Describe the mesh of FIELD, and at which λ it has samples of a field."""
    from .. import native
    from ..readers import NoFieldError, read_field, read_mesh

    phases = Phases()
    load_core()
    with phases("read"):
        try:
            data = read_field(field, vector=vector, sphere_faces=sphere_faces)
            surface, lambdas = data.mesh, data.lambdas
        except NoFieldError:  # a mesh alone is worth describing too
            surface, lambdas = read_mesh(field), np.zeros(0)
    with phases("mesh"):
        mesh = native.TriangleMesh(surface.vertices, surface.triangles)
    write_json(
        out,
        {
            "schema": "stormfield.info/1",
            "mesh": describe_mesh(mesh),
            "lam": [float(lam) for lam in lambdas],
            "seconds": phases.seconds,
        },
    )
