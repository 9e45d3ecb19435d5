# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield track FIELD: the paths of fixed points over λ, and their bifurcations."""

from __future__ import annotations

import click
import numpy as np

from ..analysis.tracking import MIN_LIFE
from ..model.errors import InputError
from ..readers import read_series
from .field_input import FieldInput, field_command
from .following import followed_whole, write_part
from .group import cli
from .memory import limit_of
from .parquet import parquet_option, write_parquet
from .window import window_options


def not_negative(_context: click.Context, parameter: click.Parameter, least: float) -> float:
    if not 0.0 <= least < np.inf:
        raise InputError(f"{parameter.opts[0]} {least:g} is out of range; choose a number from 0")
    return least


def _positive(_context: click.Context, parameter: click.Parameter, given: float | None) -> float | None:
    if given is not None and not 0.0 < given < np.inf:
        raise InputError(f"{parameter.opts[0]} {given:g} is out of range; choose a number above 0")
    return given


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
@parquet_option
@window_options
@click.option(
    "--windows",
    type=click.IntRange(1),
    help="Follow in that many windows: at once by Dask where it is installed, else one after another.  "
    "[default: as many as memory needs, one after another]",
)
@click.option("--scheduler", help="Address of Dask's scheduler, for --windows.  [default: processes of this machine]")
@click.option(
    "--memory",
    type=float,
    callback=_positive,
    help="Memory that the samples which are followed at once may take, GB.  [default: half of what is free]",
)
def track(
    given: FieldInput,
    min_life: float,
    min_strength: float,
    parquet: str | None,
    start: str | None,
    to: str | None,
    windows: int | None,
    scheduler: str | None,
    memory: float | None,
) -> None:
    """Follow the fixed points of FIELD over λ, from their creation to their annihilation.

    With --from or --to only a window is followed, and written as a part that `stormfield stitch` joins to others.
    --min-life and --min-strength belong to stitch then. --windows does both at once, with the same result as in one
    piece. Samples that do not fit into memory together are followed in windows without being asked, which is said.

    Between two samples the field is linear in λ. What moves by more than two of its radii from one sample to the next
    fades and grows there instead of moving, and breaks into several paths: give samples that are closer.
    """
    from ..analysis import tracking
    from ..figures.image import draw_tracking

    if len(given.data.lambdas) < 2:
        raise InputError(f"{given.name}: has one sample of λ, so that nothing changes; use stormfield analyze")
    if scheduler is not None and windows is None:
        raise InputError("--scheduler is for windows; give their number with --windows")
    limit = limit_of(memory)
    if start is not None or to is not None:
        if parquet is not None:
            raise InputError("--parquet is for the whole; give it to stormfield stitch")
        write_part(given, start, to, limit)
        return
    whole = followed_whole(given, windows, scheduler, limit)
    with given.phases("persistence"):
        found = tracking.from_native(whole.tracking, min_life, min_strength, whole.region)
    given.note(whole.region.note)
    if whole.zero_vectors and not whole.region.note:
        count = len(whole.lambdas) * given.mesh.vertex_count
        given.note(f"{whole.zero_vectors} of {count} vectors are zero; fixed points among them are degenerate")
    given.draw(draw_tracking, found)
    written = given.write(
        "stormfield.tracking/1",
        {
            "lam": whole.lambdas,
            "min_life": min_life,
            "min_strength": min_strength,
            "zero_vectors": whole.zero_vectors,
            "zero_regions": whole.region.to_json(),
            **tracking.to_json(found),
        },
    )
    if parquet is not None:
        write_parquet(parquet, written)
