# SPDX-License-Identifier: GPL-3.0-or-later
"""The times of samples: dates where calendar and offset are known, else the numbers of the file; never invented."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from ...model.errors import InputError
from ..geography import COMMON, EPOCH, dates_of
from .vocabulary import is_lead, is_time, unit


@dataclass(frozen=True, eq=False)
class Times:
    """numbers (s,) in `unit`, or None where the file has no times. dates: ISO 8601 of each, empty where `unit` and
    `calendar` give none."""

    numbers: np.ndarray | None
    unit: str = ""
    calendar: str = "standard"
    dates: tuple[str, ...] = ()

    def __getitem__(self, chosen: np.ndarray) -> Times:
        """The times of some samples."""
        if self.numbers is None:
            return self
        return replace(
            self,
            numbers=self.numbers[chosen],
            dates=tuple(np.asarray(self.dates, object)[chosen]) if self.dates else (),
        )


def times_of(dataset, dim: str) -> Times:
    """The times along a dimension of the dataset."""
    along = [name for name in dataset.variables if dataset[name].dims[:1] == (dim,) and _tells(dataset, str(name), dim)]
    # The time that is meant is the valid one, where a forecast has more.
    order = sorted(along, key=lambda name: (standard(dataset[name]) != "time", name not in ("valid_time", dim)))
    for name in order:
        found = decoded(dataset[name])
        if found.numbers is not None:
            return found
    return Times(None)


def standard(variable) -> str:
    return str(variable.attrs.get("standard_name", ""))


def within(times: Times, first: str, last: str, where: str) -> np.ndarray:
    """Which samples lie between two times, both included: dates, or numbers in the file's unit."""
    if times.numbers is None:
        raise InputError(f"{where}: has no times to choose from by --times")
    low, high = (_number(times, word, where) for word in (first, last))
    chosen = np.flatnonzero((times.numbers >= low - 1e-9 * abs(low)) & (times.numbers <= high + 1e-9 * abs(high)))
    if not len(chosen):
        shown = times.dates or tuple(f"{number:g}" for number in times.numbers)
        of = "" if times.dates or not times.unit else f" {times.unit}"
        raise InputError(
            f"{where}: has no time from {first} to {last}; it has {len(shown)}, {shown[0]} to {shown[-1]}{of}"
        )
    return chosen


def _number(times: Times, word: str, where: str) -> float:
    if not times.dates:
        try:
            return float(word)
        except ValueError:
            raise InputError(f"{where}: {word} is no time here; give a number of {times.unit or 'the file'}") from None
    import cftime

    date = _date(word, times.calendar)
    if date is not None:
        return float(cftime.date2num(date, times.unit, times.calendar))
    try:
        return float(word)
    except ValueError:
        raise InputError(f"{where}: {word} is no date; write 2018-10-07 or 2018-10-07T06:00") from None


def _date(word: str, calendar: str):
    import cftime

    found = re.fullmatch(
        r"(-?\d{4,})-(\d{1,2})-(\d{1,2})(?:[T_ ](\d{1,2})(?::?(\d{2}))?(?::?(\d{2}(?:\.\d*)?))?Z?)?", word.strip()
    )
    if found is None:
        return None
    parts = [float(part) if part else 0.0 for part in found.groups()]
    try:
        return cftime.datetime(*(int(part) for part in parts), calendar=calendar)
    except ValueError:
        return None


def _tells(dataset, name: str, dim: str) -> bool:
    variable = dataset[name]
    if variable.ndim >= 2:  # characters of the WRF
        return name in ("Times", "DateStrLen") and variable.dtype.kind == "S"
    return variable.ndim == 1 and (is_time(name, variable) or is_lead(name, variable) or name == dim)


def decoded(variable) -> Times:
    """The times that a variable holds, one or many."""
    values = np.atleast_1d(variable.values)
    if values.ndim >= 2:
        values = np.array([b"".join(row) for row in values.reshape(len(values), -1)])
    if np.issubdtype(values.dtype, np.datetime64):
        return _with_dates(values.astype("datetime64[ns]").astype(np.int64) / 1e9, EPOCH, "standard")
    if np.issubdtype(values.dtype, np.timedelta64):
        return Times(values.astype("timedelta64[ns]").astype(np.int64) / 1e9, "seconds")
    if values.dtype.kind in "SUO":
        return _from_text(values)
    if not np.issubdtype(values.dtype, np.number) or not np.isfinite(values).all():
        return Times(None)
    calendar = str(variable.encoding.get("calendar", variable.attrs.get("calendar", "standard"))).lower()
    return _with_dates(values.astype(np.float64), unit(variable), calendar)


def _from_text(values) -> Times:
    import cftime

    words = [value.decode(errors="replace") if isinstance(value, bytes) else str(value) for value in values]
    dates = [_date(word, "standard") for word in words]
    if not words or any(date is None for date in dates):
        return Times(None)
    return _with_dates(np.asarray(cftime.date2num(dates, EPOCH), np.float64), EPOCH, "standard")


def _with_dates(numbers: np.ndarray, unit: str, calendar: str) -> Times:
    """Dates where cftime knows them, checked back: what it rounds or does not know stays a number."""
    plain = Times(numbers, unit, calendar)
    if " since " not in unit:
        return plain
    if unit == EPOCH and calendar in COMMON:
        return replace(plain, dates=tuple(dates_of(numbers, unit, calendar)))
    import cftime

    try:
        dates = cftime.num2date(numbers, unit, calendar)
        again = cftime.date2num(dates, unit, calendar)
    except (ValueError, OverflowError, TypeError):
        return plain
    span = float(np.ptp(numbers)) or 1.0
    if not np.allclose(np.asarray(again, np.float64), numbers, rtol=1e-9, atol=1e-6 * span):
        return plain
    return replace(plain, dates=tuple(dates_of(numbers, unit, calendar)))
