# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield morse FIELD: the Morse sets of the field at one λ, and their order."""

from __future__ import annotations

from typing import Unpack

import click

from ..model.words import MorseOptions
from .field_input import FieldInput, field_command, lam_option
from .group import cli
from .progress import progress


@cli.command()
@field_command("Picture of the Morse sets and their graph")
@lam_option
@click.option(
    "--method",
    type=click.Choice(["geometry", "tau", "spatial"]),
    default="geometry",
    show_default=True,
    help="Map of the faces: directions across edges, flow for a time, flow for a length.",
)
@click.option("--tau", type=float, help="Seconds (tau) or mesh units (spatial).  [default: a few edges]")
@click.option("--refine", is_flag=True, help="Refine coarse sets by larger tau (geometry: smaller pieces of edges).")
@click.option("--tau-max", type=float, help="Largest tau of a refinement.")
@click.option("--max-seconds", type=float, help="Time after which a refinement stops.")
@click.option(
    "--eps",
    "--epsilon",
    "eps",
    type=float,
    default=0.0,
    help="Bound on the error of the vectors, mesh units per second; geometry only, refined or not.",
)
@click.option("--relative", is_flag=True, help="--eps is in mean speeds of the field.")
@click.option(
    "--persistence/--no-persistence",
    default=None,
    help="Find the eps at which each set merges with another.  [default: geometry without --refine]",
)
@click.option(
    "--trivial/--no-trivial", "keep_trivial", default=True, help="Keep sets of trivial index.  [default: yes]"
)
def morse(given: FieldInput, lam: float | None, **options: Unpack[MorseOptions]) -> None:
    """Divide the surface of FIELD into Morse sets and what flows between them."""
    from .. import native
    from ..analysis import mcg
    from ..figures.image import draw_morse
    from ..work import result_of, run

    lam = float(given.data.lambdas[0]) if lam is None else lam
    with given.phases("read"):
        vectors = given.data.at(lam)
    with given.phases("mesh"):
        field = native.VectorField.from_space(given.mesh, vectors)
    with progress("Morse sets") as show:
        decomposition = run(result_of(native.start_morse(field, **options), 0.0, "dividing the surface"), show)
    given.phases.seconds.update(decomposition.seconds)
    with given.phases("graph"):
        graph = mcg.morse_graph(decomposition, given.mesh, lam)
    given.draw(draw_morse, vectors, graph, decomposition.face_sets)
    given.write("stormfield.morse/1", {"lam": lam, **mcg.morse_json(decomposition, graph)})
