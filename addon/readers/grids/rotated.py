# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids whose rows and columns are latitudes and longitudes about another pole, as regional models take it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...model.errors import InputError
from .vocabulary import attributes, unit

MAPPING = "rotated_latitude_longitude"
POLE = ("grid_north_pole_latitude", "grid_north_pole_longitude")


def rotated_axes(dataset, variable, where: str) -> tuple[Any, Any, np.ndarray, np.ndarray] | None:
    """(rows, columns, latitudes, longitudes), the latter two (a, b) in degrees, where the grid mapping of a variable is
    a rotated pole; None where it is not. Raises InputError where the mapping says too little."""
    name = str(attributes(variable).get("grid_mapping", "")).split(":")[0].strip()
    if name not in dataset.variables or dataset[name].attrs.get("grid_mapping_name") != MAPPING:
        return None
    mapping = dataset[name].attrs
    for key in POLE:
        if not np.isscalar(mapping.get(key)) or not np.isfinite(float(mapping[key])):
            raise InputError(f"{where}: {name}, a rotated pole, lacks {key}; add it")
    pole = [float(mapping[key]) for key in POLE]
    axes = [dataset[dim] for dim in variable.dims if dim in dataset.variables and _is_angle(dataset[dim])][-2:]
    if len(axes) < 2:
        return None
    rows, columns = sorted(axes, key=lambda axis: not _is_row(axis))
    north = float(mapping.get("north_pole_grid_longitude", 0.0))
    latitude, longitude = geographic(rows.values[:, None], columns.values[None] - north, *pole)
    return rows, columns, latitude, longitude


def geographic(latitude, longitude, pole_latitude: float, pole_longitude: float) -> tuple[np.ndarray, np.ndarray]:
    """Degrees about a pole → latitudes and longitudes of the earth (CF conventions, appendix F)."""
    phi, theta, pole = np.radians(latitude), np.radians(longitude), np.radians(pole_latitude)
    sine = np.sin(pole) * np.sin(phi) + np.cos(pole) * np.cos(phi) * np.cos(theta)
    turned = np.arctan2(
        np.cos(phi) * np.sin(theta), np.sin(pole) * np.cos(phi) * np.cos(theta) - np.cos(pole) * np.sin(phi)
    )
    return np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0))), np.degrees(turned) + pole_longitude + 180.0


def _is_angle(axis) -> bool:
    return axis.ndim == 1 and unit(axis).lower().startswith("degree")


def _is_row(axis) -> bool:
    return axis.attrs.get("standard_name") in ("grid_latitude", "latitude") or "lat" in str(axis.name).lower()
