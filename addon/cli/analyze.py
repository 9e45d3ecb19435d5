"""stormfield analyze FIELD: the topology of the field at one λ."""

from typing import Any

import click

from . import cli
from .blender import load_core
from .output import Phases, check_lam, describe_mesh, field_argument, write_json


@cli.command()
@field_argument
@click.option("--lam", type=float, help="λ of the instantaneous field, 0..1.  [default: the first sample]")
@click.option("--attribute", default="sf_advection", show_default=True, help="Vector attribute of a cache.")
@click.option("--json", "out", required=True, help="File to write; - is standard output.")
def analyze(
    field: str, vector: str | None, sphere_faces: int | None, lam: float | None, attribute: str, out: str
) -> None:
    """Find the fixed points of FIELD."""
    from .. import native
    from ..readers import read_field

    check_lam(lam)
    phases = Phases()
    load_core()
    with phases("read"):
        data = read_field(field, vector=vector, sphere_faces=sphere_faces, attribute=attribute)
        lam = float(data.lambdas[0]) if lam is None else lam
    with phases("mesh"):
        mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    with phases("fixed_points"):
        instant = native.VectorField.from_space(mesh, data.at(lam))
        points = native.fixed_points(instant)
    write_json(
        out,
        {
            "schema": "stormfield.analysis/1",
            "mesh": describe_mesh(mesh),
            "lam": lam,
            "fixed_points": [_fixed_point(point) for point in points],
            "index_sum": int(instant.poincare_indices().sum()),
            "seconds": phases.seconds,
        },
    )


def _fixed_point(point: Any) -> dict[str, Any]:
    return {
        "position": [float(x) for x in point.position],
        "face": int(point.face),
        "barycentric": [float(b) for b in point.barycentric],
        "kind": str(point.kind),
        "index": int(point.index),
        "rotation": float(point.rotation),
        "jacobian": [[float(x) for x in row] for row in point.jacobian],
    }
