# SPDX-License-Identifier: GPL-3.0-or-later
"""Places and times of a field on the earth, beside positions and λ."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..model.words import Json

#: Calendars that are the one of datetime64, from its introduction on.
COMMON = ("standard", "gregorian", "proleptic_gregorian")
EPOCH = "seconds since 1970-01-01"
#: Units of time, and their seconds.
LENGTHS = (
    ({"s", "sec", "secs", "second", "seconds"}, 1.0),
    ({"min", "mins", "minute", "minutes"}, 60.0),
    ({"h", "hr", "hrs", "hour", "hours"}, 3600.0),
    ({"d", "day", "days"}, 86400.0),
)
#: NumPy's own rounds the last bit by where its arrays happen to lie in memory.
_ARCTAN2 = np.frompyfunc(math.atan2, 2, 1)


@dataclass(frozen=True, eq=False)
class Geography:
    """spherical: positions lie on a sphere around the origin, x to 0° E on the equator, z to the north pole. numbers
    (s,): times of the samples in `unit`, None where there are none; calendar: the one of CF that makes them dates,
    empty where none does."""

    spherical: bool
    numbers: np.ndarray | None = None
    unit: str = ""
    calendar: str = ""

    def to_json(self) -> dict[str, Json]:
        """Plain values, from which from_json makes the same."""
        ends = None if self.numbers is None else [float(self.numbers[0]), float(self.numbers[-1])]
        return {"spherical": self.spherical, "ends": ends, "unit": self.unit, "calendar": self.calendar}

    @classmethod
    def from_json(cls, given: dict[str, Json]) -> Geography:
        numbers = None if given["ends"] is None else np.array(given["ends"])
        return cls(given["spherical"], numbers, given["unit"], given["calendar"])

    @property
    def seconds(self) -> float | None:
        """From the first time to the last; None where the file does not say how long its numbers are."""
        if self.numbers is None:
            return None
        word = self.unit.split(" since ")[0].strip().lower()
        length = next((size for names, size in LENGTHS if word in names), None)
        return None if length is None else float(self.numbers[-1] - self.numbers[0]) * length

    def latitude_longitude(self, positions) -> np.ndarray:
        """(..., 3) → (..., 2) degrees north, and east from −180 to 180."""
        x, y, z = np.moveaxis(np.asarray(positions, np.float64), -1, 0)
        latitude, longitude = _ARCTAN2(z, np.hypot(x, y)), _ARCTAN2(y, x)
        return np.degrees(np.stack([latitude, longitude], axis=-1).astype(np.float64))

    def times(self, lambdas) -> list[str] | list[float] | None:
        """When each λ is: dates to the second, or numbers in the file's unit; None where the file has no times."""
        if self.numbers is None:
            return None
        numbers = self.numbers[0] + np.asarray(lambdas, np.float64) * (self.numbers[-1] - self.numbers[0])
        return dates_of(numbers, self.unit, self.calendar) if self.calendar else numbers.tolist()

    def time(self, lam: float) -> str | float | None:
        """The same of one λ."""
        times = self.times([lam])
        return None if times is None else times[0]


def dates_of(numbers: np.ndarray, unit: str, calendar: str) -> list[str]:
    """ISO 8601, to the nearest second."""
    if not len(numbers):
        return []
    if unit == EPOCH and calendar in COMMON:  # needs no cftime
        seconds = np.floor(numbers + 0.5).astype("timedelta64[s]")
        return np.datetime_as_string(np.datetime64("1970-01-01") + seconds, "s").tolist()
    from datetime import timedelta

    import cftime

    first = cftime.num2date(float(numbers[0]), unit, calendar)
    second = cftime.num2date(float(numbers[0]) + 1.0, unit, calendar) - first
    if calendar in COMMON and first.year > 1582:
        start = np.datetime64(first.isoformat(), "us")
        microseconds = np.round((numbers - numbers[0]) * (second / timedelta(microseconds=1)))
        return np.datetime_as_string(
            start + microseconds.astype("timedelta64[us]") + np.timedelta64(500000, "us"), "s"
        ).tolist()
    half = timedelta(microseconds=500000)
    return [(date + half).replace(microsecond=0).isoformat() for date in cftime.num2date(numbers, unit, calendar)]
