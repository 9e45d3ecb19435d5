# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths and bifurcations of a tracking as tables of Apache Parquet, for results that are too large for JSON.

paths.parquet          name, kind, index, life, strength, rotation, begin, end
samples.parquet        path, lam, x, y, z, kind, and of data on the earth latitude, longitude, time
bifurcations.parquet   lam, x, y, z, kind, node, paths, and of data on the earth latitude, longitude, time
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import Any

import click

from ..model.errors import InputError
from ..model.words import Json


def parquet_option(command: Callable[..., None]) -> Callable[..., None]:
    """--parquet, checked before anything is read."""
    return click.option(
        "--parquet",
        metavar="DIR",
        callback=_checked,
        help="Folder for paths.parquet, samples.parquet and bifurcations.parquet, beside the JSON.",
    )(command)


def _checked(_context: click.Context, _parameter: click.Parameter, folder: str | None) -> str | None:
    if folder is not None:
        try:
            importlib.import_module("pyarrow.parquet")
        except ImportError as error:
            raise InputError(
                f"--parquet needs pyarrow, which cannot be loaded ({error}): pip install stormfield[parquet]"
            ) from error
    return folder


def write_parquet(folder: str, content: dict[str, Json]) -> None:
    """content: that of stormfield.tracking/1. Raises InputError where the folder cannot be written."""
    import pyarrow
    from pyarrow import parquet

    tables = {
        "paths": _paths(content["paths"]),
        "samples": _samples(content["paths"]),
        "bifurcations": _bifurcations(content["bifurcations"]),
    }
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        for name, columns in tables.items():
            parquet.write_table(pyarrow.table(columns), Path(folder) / f"{name}.parquet")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written ({error}); choose another place") from error


def _paths(paths: list[Json]) -> dict[str, Any]:
    numbers = {name: _floats([path[name] for path in paths]) for name in ("life", "strength", "rotation")}
    return {
        "name": _words([path["name"] for path in paths]),
        "kind": _words([path["kind"] for path in paths]),
        "index": _integers([path["index"] for path in paths]),
        **numbers,
        "begin": _words([path["ends"][0] for path in paths]),
        "end": _words([path["ends"][1] for path in paths]),
    }


def _samples(paths: list[Json]) -> dict[str, Any]:
    rows = list(chain.from_iterable(path["samples"] for path in paths))
    columns = {
        "path": _words([path["name"] for path in paths for _ in path["samples"]]),
        **{name: _floats([row[k] for row in rows]) for k, name in enumerate(("lam", "x", "y", "z"))},
        "kind": _words([kind for path in paths for kind in path["kinds"]]),
    }
    if any("places" in path for path in paths):
        places = list(chain.from_iterable(path["places"] for path in paths))
        columns |= {name: _floats([place[k] for place in places]) for k, name in enumerate(("latitude", "longitude"))}
    if any("times" in path for path in paths):
        columns["time"] = list(chain.from_iterable(path["times"] for path in paths))
    return columns


def _bifurcations(events: list[Json]) -> dict[str, Any]:
    columns = {
        "lam": _floats([event["lam"] for event in events]),
        **{name: _floats([event["position"][k] for event in events]) for k, name in enumerate("xyz")},
        "kind": _words([event["kind"] for event in events]),
        "node": _words([event["node"] for event in events]),
        "paths": [event["paths"] for event in events],
    }
    for name in ("latitude", "longitude", "time"):
        if any(name in event for event in events):
            columns[name] = [event[name] for event in events]
    return columns


def _floats(values: list) -> Any:
    return _array(values, "float64")


def _integers(values: list) -> Any:
    return _array(values, "int64")


def _words(values: list) -> Any:
    return _array([str(value) for value in values], "string")


def _array(values: list, kind: str) -> Any:
    """A column whose type does not depend on its values, so that empty tables are like others."""
    import pyarrow

    return pyarrow.array(values, pyarrow.type_for_alias(kind))
