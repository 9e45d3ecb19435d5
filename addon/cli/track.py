# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield track FIELD: the paths of fixed points over λ, and their bifurcations."""

import click
import numpy as np

from ..analysis.tracking import MIN_LIFE
from ..model.errors import InputError
from ..readers import read_series
from .field_input import FieldInput, field_command
from .group import cli
from .progress import progress
from .window import window_of, window_options


def not_negative(_context: click.Context, parameter: click.Parameter, least: float) -> float:
    if not 0.0 <= least < np.inf:
        raise InputError(f"{parameter.opts[0]} {least:g} is out of range; choose a number from 0")
    return least


@cli.command()
@field_command("Picture of the paths and their life spans", read_series)
@click.option(
    "--min-life",
    type=float,
    default=MIN_LIFE,
    show_default=True,
    callback=not_negative,
    help="Paths shorter than this fraction of λ are taken out: pairs go together, folds become one path. 0 keeps all.",
)
@click.option(
    "--min-strength",
    type=float,
    default=0.0,
    show_default=True,
    callback=not_negative,
    help="Weaker paths are left out, 1/s.",
)
@window_options
def track(given: FieldInput, min_life: float, min_strength: float, start: str | None, to: str | None) -> None:
    """Follow the fixed points of FIELD over λ, from their creation to their annihilation.

    With --from or --to only a window is followed, and written as a part that `stormfield stitch` joins to others.
    --min-life and --min-strength belong to stitch then.
    """
    from .. import native
    from ..analysis import tracking
    from ..analysis.no_field import region_without_field
    from ..analysis.windows import SCHEMA, window_json
    from ..figures.image import draw_tracking
    from ..work import result_of, run

    data, mesh = given.data, given.mesh
    if len(data.lambdas) < 2:
        raise InputError(f"{given.name}: has one sample of λ, so that nothing changes; use stormfield analyze")
    window = window_of(data, start, to, given.name)
    with given.phases("track"), progress("Tracking") as show:
        tangents = np.stack([native.VectorField.from_space(mesh, vectors).values for vectors in window.vectors])
        job = tracking.start(native.ParameterizedField(mesh, np.asarray(window.lambdas, np.float64), tangents))
        followed = run(result_of(job, 0.0, "following fixed points"), show)
    if start is not None or to is not None:
        given.write_part(SCHEMA, window.read, window_json(followed, mesh, window.lambdas, tangents))
        return
    with given.phases("persistence"):
        region = region_without_field(mesh, tangents)
        found = tracking.from_native(followed, min_life, min_strength, region)
    given.note(region.note)
    zeros = int((tangents == 0.0).sum())
    if zeros and not region.note:
        given.note(f"{zeros} of {tangents.size} vectors are zero; fixed points among them are degenerate")
    given.draw(draw_tracking, found)
    given.write(
        "stormfield.tracking/1",
        {
            "lam": [float(lam) for lam in data.lambdas],
            "min_life": min_life,
            "min_strength": min_strength,
            "zero_vectors": zeros,
            "zero_regions": region.to_json(),
            **tracking.to_json(found),
        },
    )
