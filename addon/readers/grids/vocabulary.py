# SPDX-License-Identifier: GPL-3.0-or-later
"""What attributes and names of variables mean, in the conventions of CF, GRIB, ERA5, GFS, WRF, MERRA, HYCOM, CMEMS,
AVISO, ICON, UGRID. Attributes count before names, because names are taken freely.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

#: Names of coordinates, in lower case, where no attribute says what they are.
LATITUDE = {"lat", "latitude", "nav_lat", "xlat", "clat", "elat", "vlat", "tlat", "ulat", "lats", "geolat", "ylat"}
LONGITUDE = {"lon", "longitude", "nav_lon", "xlong", "clon", "elon", "vlon", "tlong", "ulong", "lons", "geolon", "xlon"}
LATITUDE |= {"lat_rho", "g0_lat_0", "lat_0", "latcell", "gridlat_0", "xlat_m", "long_lat", "lat2d", "y_lat"}
LONGITUDE |= {"lon_rho", "g0_lon_1", "lon_0", "loncell", "gridlon_0", "xlong_m", "long", "lon2d", "x_lon"}
TIME = {"time", "times", "valid_time", "xtime", "t", "ocean_time", "time_counter", "mt", "date", "datetime", "day"}
LEAD = {"step", "lead", "lead_time", "leadtime", "prediction_timedelta", "forecast_time", "forecast_period", "fhour"}
MEMBER = {"number", "member", "realization", "ensemble", "ens", "ensemble_member", "perturbationnumber", "sample"}
LEVEL = {"level", "lev", "levels", "plev", "pressure", "pressure_level", "isobaric", "isobaricinhpa", "depth", "depthu"}
LEVEL |= {
    "depthv",
    "deptht",
    "z",
    "height",
    "altitude",
    "bottom_top",
    "sigma",
    "s_rho",
    "hybrid",
    "z_t",
    "alt",
    "pfull",
}
LEVEL |= {"heightaboveground", "model_level", "model_level_number", "nz", "st_ocean", "elevation", "height_2", "plev_2"}

STANDARD_LEVEL: tuple[str, ...] = (
    "air_pressure",
    "height",
    "altitude",
    "depth",
    "model_level_number",
    "atmosphere_",
    "ocean_sigma",
)
STANDARD_LEVEL += ("ocean_s_coordinate", "pressure", "ocean_double_sigma", "ocean_layer", "ocean_z_coordinate")


def attributes(variable) -> dict[str, Any]:
    """Attributes of a variable, and what decoding moved into its encoding."""
    return {**variable.encoding, **variable.attrs}


def standard_name(variable) -> str:
    """The CF standard name, or what GRIB says it is; empty where nothing does."""
    for key in ("standard_name", "GRIB_cfName"):
        name = str(variable.attrs.get(key, "")).strip().lower()
        if name and name not in {"unknown", "undefined", "none"}:
            return name
    return ""


def unit(variable) -> str:
    return str(attributes(variable).get("units", "")).strip()


def is_latitude(name: str, variable) -> bool:
    return _is_degrees(variable, "latitude", "n", "Lat") or _unsaid(variable, name, LATITUDE)


def is_longitude(name: str, variable) -> bool:
    return _is_degrees(variable, "longitude", "e", "Lon") or _unsaid(variable, name, LONGITUDE)


def is_time(name: str, variable) -> bool:
    if standard_name(variable) in {"time", "forecast_reference_time"} or variable.attrs.get("axis") == "T":
        return standard_name(variable) != "forecast_period"
    if " since " in unit(variable) or np.issubdtype(variable.dtype, np.datetime64):
        return True
    return _unsaid(variable, name, TIME)


def is_lead(name: str, variable) -> bool:
    return standard_name(variable) == "forecast_period" or _unsaid(variable, name, LEAD)


def is_member(name: str, variable) -> bool:
    return standard_name(variable) == "realization" or _unsaid(variable, name, MEMBER)


def is_level(name: str, variable) -> bool:
    meaning = standard_name(variable)
    if any(meaning.startswith(word) for word in STANDARD_LEVEL):
        return True
    if variable.attrs.get("axis") == "Z" or "positive" in variable.attrs:
        return True
    if unit(variable).lower() in {"hpa", "pa", "mb", "mbar", "millibar", "millibars"}:
        return True
    return _unsaid(variable, name, LEVEL) or bool(
        re.match(r"(isobaric|height_above_ground|depth|lv_)\w*$", name.lower())
    )


def _is_degrees(variable, meaning: str, letter: str, axis: str) -> bool:
    if standard_name(variable):
        return standard_name(variable) == meaning
    if variable.attrs.get("_CoordinateAxisType") == axis:
        return True
    return bool(
        re.fullmatch(
            rf"degrees?_?({meaning[:-4]}|{letter}|{'north' if letter == 'n' else 'east'})", unit(variable).lower()
        )
    )


def _unsaid(variable, name: str, names: set[str]) -> bool:
    """By its name, where no standard name contradicts."""
    return not standard_name(variable) and name.lower() in names


#: Units of speed, in metres per second.
SPEEDS = {
    "m s-1": 1.0,
    "cm s-1": 0.01,
    "mm s-1": 0.001,
    "km s-1": 1000.0,
    "km h-1": 1.0 / 3.6,
    "kt": 1852.0 / 3600.0,
    "mph": 0.44704,
    "m day-1": 1.0 / 86400.0,
    "km day-1": 1000.0 / 86400.0,
    "ft s-1": 0.3048,
}
_LENGTH = {
    "meter": "m",
    "metre": "m",
    "meters": "m",
    "metres": "m",
    "centimeter": "cm",
    "centimeters": "cm",
    "kilometer": "km",
}
_TIME = {
    "s": "s",
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "h": "h",
    "hr": "h",
    "hour": "h",
    "day": "day",
    "d": "day",
}


def speed_of(unit: str) -> float | None:
    """Metres per second of one unit, however it is spelled; None where it is no speed."""
    text = unit.strip().lower()
    scaled = re.fullmatch(r"([0-9.]+(?:e[+-]?[0-9]+)?)\s*\*?\s*(\D.*)", text)
    if scaled is not None:
        speed = speed_of(scaled[2])
        return None if speed is None else float(scaled[1]) * speed
    if text.startswith("(") and text.endswith(")"):
        return speed_of(text[1:-1])
    if text in {"knots", "knot", "kts", "kt", "kn"}:
        return SPEEDS["kt"]
    if text in {"mph", "mi/h", "miles per hour"}:
        return SPEEDS["mph"]
    words = re.fullmatch(r"([a-z]+)\s*(?:/|\.|\*|\s+per\s+|\s)?\s*([a-z]+)\s*(?:\^|\*\*)?\s*(-1|)", text)
    if words is None:
        return None
    length, time, power = words.groups()
    per = power == "-1" or "/" in text or " per " in text
    length, time = _LENGTH.get(length, length), _TIME.get(time, "")
    return SPEEDS.get(f"{length} {time}-1") if per else None
