# SPDX-License-Identifier: GPL-3.0-or-later
"""Latitudes, longitudes and times beside the positions, λ and periods of a result."""

from __future__ import annotations

import numpy as np

from ..model.words import Json
from ..readers import Geography

SECONDS_A_DAY = 86400.0


def located(content: dict[str, Json], geography: Geography) -> dict[str, Json]:
    """The content of a JSON file with what `geography` says of each part:

    latitude, longitude   of a `position`, degrees
    places                (k, 2) of the `samples` or `points` of paths and orbits
    time, times           of `lam`, of `samples`
    period_days           of a `period`
    """
    return {name: _part(value, geography) for name, value in content.items()} | _beside(content, geography)


def _part(value: Json, geography: Geography) -> Json:
    if isinstance(value, dict):
        return located(value, geography)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return [_part(part, geography) for part in value]
    return value


def _beside(part: dict[str, Json], geography: Geography) -> dict[str, Json]:
    more: dict[str, Json] = {}
    if geography.spherical:
        if "position" in part:
            more["latitude"], more["longitude"] = geography.latitude_longitude(part["position"]).tolist()
        points = [row[1:] for row in part["samples"]] if "samples" in part else part.get("points")
        if points:
            more["places"] = geography.latitude_longitude(points).tolist()
    if "period" in part:
        more["period_days"] = part["period"] / SECONDS_A_DAY
    if "samples" in part:
        more |= _known("times", geography.times(np.array([row[0] for row in part["samples"]])))
    if isinstance(part.get("lam"), float):
        more |= _known("time", geography.time(part["lam"]))
    elif "lam" in part:
        more |= _known("times", geography.times(np.array(part["lam"])))
    return more


def _known(name: str, value: Json) -> dict[str, Json]:
    return {} if value is None else {name: value}
