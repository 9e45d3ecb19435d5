"""stormfield track FIELD: the paths of fixed points over λ, and their bifurcations."""

import sys

import click
import numpy as np

from ..model.errors import InputError
from . import cli
from .blender import load_core
from .output import Phases, describe_mesh, field_argument, write_json
from .progress import progress


@cli.command()
@field_argument
@click.option("--attribute", default="sf_advection", show_default=True, help="Vector attribute of a cache.")
@click.option(
    "--min-life",
    type=float,
    default=0.005,
    show_default=True,
    help="Paths shorter than this part of λ are taken out: pairs go together, folds become one path. 0 keeps all.",
)
@click.option("--min-strength", type=float, default=0.0, show_default=True, help="Weaker paths are left out, 1/s.")
@click.option("--json", "out", required=True, help="File to write; - is standard output.")
@click.option("--image", help="Picture of the paths and their life spans: .png, .pdf or .svg.")
def track(
    field: str,
    vector: str | None,
    sphere_faces: int | None,
    attribute: str,
    min_life: float,
    min_strength: float,
    out: str,
    image: str | None,
) -> None:
    """Follow the fixed points of FIELD over λ, from their creation to their annihilation."""
    from .. import native
    from ..analysis import tracking
    from ..analysis.image import check as check_image
    from ..analysis.steps import result_of
    from ..bake.job import run
    from ..readers import read_field

    for name, least in (("--min-life", min_life), ("--min-strength", min_strength)):
        if not 0.0 <= least < np.inf:
            raise InputError(f"{name} {least:g} is out of range; choose a number from 0")
    if image is not None:
        check_image(image)
    phases = Phases()
    load_core()
    with phases("read"):
        data = read_field(field, vector=vector, sphere_faces=sphere_faces, attribute=attribute)
    if len(data.lambdas) < 2:
        raise InputError(f"{field}: has one sample of λ, so that nothing changes; use stormfield analyze")
    with phases("mesh"):
        mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    with phases("track"), progress("Tracking") as show:
        tangents = np.stack([native.VectorField.from_space(mesh, vectors).values for vectors in data.vectors])
        job = tracking.start(native.ParameterizedField(mesh, np.asarray(data.lambdas, np.float64), tangents))
        followed = run(result_of(job, 0.0, "following fixed points"), show)
    with phases("persistence"):
        found = tracking.from_native(followed, min_life, min_strength)
    zeros = int((tangents == 0.0).sum())
    if zeros:
        print(
            f"note: {zeros} of {tangents.size} vectors are zero; fixed points among them are degenerate",
            file=sys.stderr,
        )
    if image is not None:
        from ..analysis.image import draw_tracking

        with phases("image"):
            draw_tracking(image, mesh, found)
    write_json(
        out,
        {
            "schema": "stormfield.tracking/1",
            "mesh": describe_mesh(mesh),
            "lam": [float(lam) for lam in data.lambdas],
            "min_life": min_life,
            "min_strength": min_strength,
            "zero_vectors": zeros,
            **tracking.to_json(found),
            "seconds": phases.seconds,
        },
    )
