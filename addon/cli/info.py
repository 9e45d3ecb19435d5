# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield info FIELD: what the mesh is, which arrays are the field, and what else there is to choose."""

import click
import numpy as np

from ..readers import Choice
from .blender import load_core
from .group import cli
from .output import Phases, describe_mesh, field_argument, write_result


@cli.command()
@field_argument
@click.option("--json", "out", default="-", show_default=True, help="File to write; - is standard output.")
def info(field: str, choice: Choice, out: str) -> None:
    """Describe the mesh of FIELD, what of it is the field and at which λ, and what else there is to choose."""
    from .. import native
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
        mesh = native.TriangleMesh(surface.vertices, surface.triangles)
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
