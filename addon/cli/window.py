# SPDX-License-Identifier: GPL-3.0-or-later
"""--from and --to: a part of the samples of a field, by the times of its data or by λ."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import click
import numpy as np

from ..model.errors import InputError
from ..readers import FieldData, Reading


def window_options(command: Callable[..., None]) -> Callable[..., None]:
    for option in (
        click.option("--to", "to", help="Last sample of a window.  [default: the last one]"),
        click.option(
            "--from",
            "start",
            help="First sample of a window, by the data's own times, else by λ: the last one that is not later. "
            "Writes a part for stormfield stitch.",
        ),
    ):
        command = option(command)
    return command


@dataclass(frozen=True, eq=False)
class Window:
    """Some of the samples of a field, at their λ in the whole: lambdas (s,), vectors s × (n, 3), which are read when
    asked for, and how they were read."""

    lambdas: np.ndarray
    vectors: Iterable[np.ndarray]
    read: Reading


def window_of(data: FieldData, start: str | None, to: str | None, name: str) -> Window:
    """The samples from `start` to `to`; None is the first and the last. Both ends go by one rule, so that windows that
    name the same time share its sample. Raises InputError."""
    times = _times(data)
    first = 0 if start is None else _sample_at(times, start, "--from", name)
    last = len(times) - 1 if to is None else _sample_at(times, to, "--to", name)
    if first >= last:
        raise InputError(f"{name}: the window from {start} to {to} has no two samples; choose times farther apart")
    part = range(first, last + 1)
    shown = tuple(data.read.times[j] for j in part) if len(data.read.times) == len(times) else data.read.times
    return Window(data.lambdas[part], data.vectors[first : last + 1], replace(data.read, times=shown))


def _times(data: FieldData) -> Sequence[float | str]:
    """Of each sample: as the data have them, else λ."""
    if len(data.read.times) == len(data.lambdas):
        return data.read.times
    known = data.geography.times(data.lambdas) if data.geography is not None else None
    return data.lambdas.tolist() if known is None else known


def _sample_at(known: Sequence[float | str], word: str, option: str, name: str) -> int:
    """The last sample that is not later."""
    try:
        if isinstance(known[0], str):
            times, wanted = _seconds(known), _seconds([word])[0]
        else:
            times, wanted = np.array(known, np.float64), float(word)
    except ValueError as error:
        raise InputError(f"{option} {word}: is no time like {known[0]}") from error
    # A time that is meant to be a sample's is not missed by rounding.
    slack = (times[-1] - times[0]) * 1e-9
    if not times[0] - slack <= wanted <= times[-1] + slack:
        raise InputError(f"{option} {word}: {name} has times from {known[0]} to {known[-1]}; choose one of those")
    return int(np.searchsorted(times, wanted + slack, side="right")) - 1


def _seconds(dates: Sequence[object]) -> np.ndarray:
    return np.array([str(date) for date in dates], "datetime64[s]").astype(np.float64)
