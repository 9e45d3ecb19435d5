# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield track FIELD: the paths of fixed points over λ, and their bifurcations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import click
import numpy as np

from ..analysis.tracking import MIN_LIFE
from ..model.errors import InputError
from ..readers import read_series
from .field_input import FieldInput, field_command
from .group import cli
from .progress import progress
from .window import window_of, window_options

if TYPE_CHECKING:
    from .. import native
    from ..analysis.stitching import Joined


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
@click.option("--windows", type=click.IntRange(1), default=1, help="Follow that many windows at once, by Dask.")
@click.option("--scheduler", help="Address of Dask's scheduler.  [default: processes of this machine]")
def track(
    given: FieldInput,
    min_life: float,
    min_strength: float,
    start: str | None,
    to: str | None,
    windows: int,
    scheduler: str | None,
) -> None:
    """Follow the fixed points of FIELD over λ, from their creation to their annihilation.

    With --from or --to only a window is followed, and written as a part that `stormfield stitch` joins to others.
    --min-life and --min-strength belong to stitch then. --windows does both at once, with the same result as in one
    piece.
    """
    from ..analysis import tracking
    from ..figures.image import draw_tracking

    if len(given.data.lambdas) < 2:
        raise InputError(f"{given.name}: has one sample of λ, so that nothing changes; use stormfield analyze")
    if start is not None or to is not None:
        _write_part(given, start, to)
        return
    whole = _in_one_piece(given) if windows == 1 else _in_windows(given, windows, scheduler)
    with given.phases("persistence"):
        found = tracking.from_native(whole.tracking, min_life, min_strength, whole.region)
    given.note(whole.region.note)
    if whole.zero_vectors and not whole.region.note:
        count = len(whole.lambdas) * given.mesh.vertex_count
        given.note(f"{whole.zero_vectors} of {count} vectors are zero; fixed points among them are degenerate")
    given.draw(draw_tracking, found)
    given.write(
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


def _in_one_piece(given: FieldInput) -> Joined:
    from ..analysis.no_field import region_without_field
    from ..analysis.stitching import Joined

    data = given.data
    followed, tangents = _followed(given, data.lambdas, data.vectors)
    zeros = int((tangents == 0.0).sum())
    return Joined(followed, region_without_field(given.mesh, tangents), [float(lam) for lam in data.lambdas], zeros)


def _in_windows(given: FieldInput, count: int, scheduler: str | None) -> Joined:
    from ..analysis.stitching import joined
    from ..work import run
    from .dask_windows import follow, windows_of

    windows = windows_of(len(given.data.lambdas), count)
    with given.phases("track"), progress("Tracking") as show:
        parts = run(follow(given.name, given.choice, windows, scheduler), show)
    with given.phases("stitch"):
        return joined(parts)


def _write_part(given: FieldInput, start: str | None, to: str | None) -> None:
    from ..analysis.windows import SCHEMA, window_json

    window = window_of(given.data, start, to, given.name)
    followed, tangents = _followed(given, window.lambdas, window.vectors)
    given.write_part(SCHEMA, window.read, window_json(followed, given.mesh, window.lambdas, tangents))


def _followed(
    given: FieldInput, lambdas: np.ndarray, vectors: Iterable[np.ndarray]
) -> tuple[native.Tracking, np.ndarray]:
    """The tracking of some samples, and their tangents."""
    from .. import native
    from ..analysis import tracking
    from ..work import result_of, run

    with given.phases("track"), progress("Tracking") as show:
        tangents = np.stack([native.VectorField.from_space(given.mesh, sample).values for sample in vectors])
        job = tracking.start(native.ParameterizedField(given.mesh, np.asarray(lambdas, np.float64), tangents))
        return run(result_of(job, 0.0, "following fixed points"), show), tangents
