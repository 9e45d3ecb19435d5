"""stormfield analyze FIELD: the topology of the field at one λ."""

import click

from . import cli
from .blender import load_core
from .output import Phases, check_lam, describe_mesh, field_argument, write_json
from .progress import progress


@cli.command()
@field_argument
@click.option("--lam", type=float, help="λ of the instantaneous field, 0..1.  [default: the first sample]")
@click.option("--attribute", default="sf_advection", show_default=True, help="Vector attribute of a cache.")
@click.option("--json", "out", required=True, help="File to write; - is standard output.")
@click.option("--image", help="Picture of the field, its entities and their graph: .png, .pdf or .svg.")
def analyze(
    field: str,
    vector: str | None,
    sphere_faces: int | None,
    lam: float | None,
    attribute: str,
    out: str,
    image: str | None,
) -> None:
    """Find the fixed points, periodic orbits and separatrices of FIELD, and how they are linked."""
    from .. import native
    from ..analysis.ecg import entity_graph, topology_json
    from ..analysis.image import check as check_image
    from ..analysis.steps import result_of
    from ..bake.job import run
    from ..readers import read_field

    check_lam(lam)
    if image is not None:
        check_image(image)
    phases = Phases()
    load_core()
    with phases("read"):
        data = read_field(field, vector=vector, sphere_faces=sphere_faces, attribute=attribute)
        lam = float(data.lambdas[0]) if lam is None else lam
    with phases("mesh"):
        mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    with phases("topology"), progress("Analyzing") as show:
        vectors = data.at(lam)
        job = native.start_topology(native.VectorField.from_space(mesh, vectors))
        topology = run(result_of(job, 0.0, "following the flow"), show)
    graph = entity_graph(topology, mesh, lam)
    if image is not None:
        from ..analysis.image import draw_analysis

        with phases("image"):
            draw_analysis(image, mesh, vectors, graph)
    write_json(
        out,
        {
            "schema": "stormfield.analysis/1",
            "mesh": describe_mesh(mesh),
            "lam": lam,
            **topology_json(topology, graph),
            "seconds": phases.seconds | topology.seconds,
        },
    )
