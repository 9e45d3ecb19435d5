# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield analyze FIELD: the topology of the field at one λ."""

from .field_input import FieldInput, field_command, lam_option
from .group import cli
from .progress import progress


@cli.command()
@field_command("Picture of the field, its entities and their graph")
@lam_option
def analyze(given: FieldInput, lam: float | None) -> None:
    """Find the fixed points, periodic orbits and separatrices of FIELD, and how they are linked."""
    from .. import native
    from ..analysis.ecg import entity_graph, topology_json
    from ..analysis.no_field import region_without_field, with_field
    from ..figures.image import draw_analysis
    from ..work import result_of, run

    lam = float(given.data.lambdas[0]) if lam is None else lam
    with given.phases("topology"), progress("Analyzing") as show:
        vectors = given.data.at(lam)
        job = native.start_topology(native.VectorField.from_space(given.mesh, vectors))
        topology = run(result_of(job, 0.0, "following the flow"), show)
    region = region_without_field(given.mesh, vectors)
    given.note(region.note)
    found = with_field(topology, region)
    graph = entity_graph(found, lam)
    given.draw(draw_analysis, vectors, graph)
    given.write("stormfield.analysis/1", {"lam": lam, **topology_json(found, graph)}, topology.seconds)
