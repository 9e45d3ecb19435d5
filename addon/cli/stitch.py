# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield stitch PARTS: windows of a tracking, made anywhere, become the tracking of the whole."""

import json
from pathlib import Path

import click

from ..analysis.tracking import MIN_LIFE
from ..model.errors import InputError
from ..model.words import Json
from ..readers import Geography
from .blender import load_core
from .group import cli
from .located import located
from .output import Phases, write_json
from .parquet import parquet_option, write_parquet
from .track import not_negative


@cli.command()
@click.argument("parts", nargs=-1, required=True, type=click.Path())
@click.option("--json", "out", required=True, help="File to write; - is standard output.")
@click.option("--min-life", type=float, default=MIN_LIFE, show_default=True, callback=not_negative, help="As of track.")
@click.option("--min-strength", type=float, default=0.0, show_default=True, callback=not_negative, help="As of track.")
@parquet_option
def stitch(parts: tuple[str, ...], out: str, min_life: float, min_strength: float, parquet: str | None) -> None:
    """Join what `stormfield track --from --to` wrote to PARTS: the same paths and bifurcations as in one piece.

    Each part shares its first and last sample with its neighbours. Hopf bifurcations and the shortest life are judged
    on whole paths.
    """
    from ..analysis import tracking
    from ..analysis.stitching import joined

    phases = Phases()
    load_core()
    with phases("read"):
        windows = [(name, _read(name)) for name in parts]
    with phases("stitch"):
        whole = joined(windows)
    with phases("persistence"):
        found = tracking.from_native(whole.tracking, min_life, min_strength, whole.region)
    first = windows[0][1]
    content = {
        "lam": whole.lambdas,
        "min_life": min_life,
        "min_strength": min_strength,
        "zero_vectors": whole.zero_vectors,
        "zero_regions": whole.region.to_json(),
        **tracking.to_json(found),
    }
    if first["geography"] is not None:
        content = located(content, Geography.from_json(first["geography"]))
    about = {"schema": "stormfield.tracking/1", "read": _whole_reading(windows), "mesh": first["mesh"]}
    write_json(out, {**about, **content, "seconds": phases.seconds})
    if parquet is not None:
        write_parquet(parquet, content)


def _read(name: str) -> Json:
    from ..analysis.windows import SCHEMA, part_from_json

    try:
        part = json.loads(Path(name).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{name}: no such file; check the name") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{name}: cannot be read ({error})") from error
    if not isinstance(part, dict) or part.get("schema") != SCHEMA:
        raise InputError(f"{name}: is no window of a tracking; write one with stormfield track --from --to")
    return part_from_json(part)


def _whole_reading(windows: list[tuple[str, Json]]) -> Json:
    """What the first part says, with the files and times of all."""
    reads = [part["read"] for _, part in sorted(windows, key=lambda window: window[1]["lam"][0])]
    files = dict.fromkeys(file for read in reads for file in read["files"])
    times = dict.fromkeys(time for read in reads for time in read["times"])
    return {**reads[0], "files": list(files), "times": list(times)}
