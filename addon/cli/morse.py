"""stormfield morse FIELD: the Morse sets of the field at one λ, and their order."""

from typing import Any

import click

from . import cli
from .blender import load_core
from .output import Phases, check_lam, describe_mesh, field_argument, write_json
from .progress import progress


@cli.command()
@field_argument
@click.option("--lam", type=float, help="λ of the instantaneous field, 0..1.  [default: the first sample]")
@click.option("--attribute", default="sf_advection", show_default=True, help="Vector attribute of a cache.")
@click.option(
    "--method",
    type=click.Choice(["geometry", "tau", "spatial"]),
    default="geometry",
    show_default=True,
    help="Map of the faces: directions across edges, flow for a time, flow for a length.",
)
@click.option("--tau", type=float, help="Seconds (tau) or mesh units (spatial).  [default: a few edges]")
@click.option("--refine", is_flag=True, help="Refine coarse sets by ever larger tau, beginning with --tau.")
@click.option("--tau-max", type=float, help="Largest tau of a refinement.")
@click.option("--seconds", type=float, help="Time after which a refinement stops.")
@click.option("--eps", type=float, default=0.0, help="Bound on the error of the vectors, mesh units per second.")
@click.option("--relative", is_flag=True, help="--eps is in mean speeds of the field.")
@click.option("--trivial/--no-trivial", default=True, help="Keep sets of trivial index.  [default: yes]")
@click.option("--json", "out", required=True, help="File to write; - is standard output.")
@click.option("--image", help="Picture of the Morse sets and their graph: .png, .pdf or .svg.")
def morse(
    field: str,
    vector: str | None,
    sphere_faces: int | None,
    lam: float | None,
    attribute: str,
    method: str,
    out: str,
    image: str | None,
    **options: Any,
) -> None:
    """Divide the surface of FIELD into Morse sets and what flows between them."""
    from .. import native
    from ..analysis import mcg
    from ..analysis.image import check as check_image
    from ..analysis.steps import result_of
    from ..bake import job
    from ..readers import read_field

    check_lam(lam)
    if image is not None:
        check_image(image)
    phases = Phases()
    load_core()
    with phases("read"):
        data = read_field(field, vector=vector, sphere_faces=sphere_faces, attribute=attribute)
        lam = float(data.lambdas[0]) if lam is None else lam
        vectors = data.at(lam)
    with phases("mesh"):
        mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
        instant = native.VectorField.from_space(mesh, vectors)
    with progress("Morse sets") as show:
        started = native.start_morse(instant, method=method, **options)
        decomposition = job.run(result_of(started, 0.0, "dividing the surface"), show)
    phases.seconds.update(decomposition.seconds)
    with phases("graph"):
        graph = mcg.morse_graph(decomposition, mesh, lam)
    if image is not None:
        from ..analysis.image import draw_morse

        with phases("image"):
            draw_morse(image, mesh, vectors, graph, decomposition.face_sets)
    write_json(
        out,
        {
            "schema": "stormfield.morse/1",
            "mesh": describe_mesh(mesh),
            "lam": lam,
            **mcg.morse_json(decomposition, graph),
            "seconds": phases.seconds,
        },
    )
