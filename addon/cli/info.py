"""stormfield info FIELD: what the mesh is."""

import click

from . import cli
from .blender import load_core
from .output import Phases, describe_mesh, field_argument, write_json


@cli.command()
@field_argument
@click.option("--json", "out", default="-", show_default=True, help="File to write; - is standard output.")
def info(field: str, vector: str | None, sphere_faces: int | None, out: str) -> None:
    """Describe the mesh of FIELD."""
    from .. import native
    from ..readers import read_field

    phases = Phases()
    load_core()
    with phases("read"):
        data = read_field(field, vector=vector, sphere_faces=sphere_faces)
    with phases("mesh"):
        mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    write_json(
        out,
        {
            "schema": "stormfield.info/1",
            "mesh": describe_mesh(mesh),
            "lam": [float(lam) for lam in data.lambdas],
            "seconds": phases.seconds,
        },
    )
