# SPDX-License-Identifier: GPL-3.0-or-later
"""Wind on a latitude-longitude grid → a field on the unit sphere.

x points to 0° E on the equator, y to 90° E, z to the north pole; u is the eastward, v the northward component, kept in
the unit of the file (metres per second, usually). The vectors are turned into space first and interpolated there,
bilinearly in latitude and longitude, so that the poles need no special case: a pole's vector is the mean around it.
Times become λ, evenly from the first to the last. Latitudes may run either way; longitudes may start anywhere and
repeat the first meridian at the end; pole rows may be absent.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..model.errors import InputError
from .field_data import FieldData
from .icosphere import icosphere
from .reading import ArrayInfo, Reading

#: Names that files use; the first that is present counts.
LATITUDE = ("lat", "latitude", "Latitude", "LAT", "y")
LONGITUDE = ("lon", "longitude", "Longitude", "LON", "x")
EAST = ("u", "u10", "U10", "10u", "ugrd10m", "UGRD_10maboveground", "uwnd", "U", "ua")
NORTH = ("v", "v10", "V10", "10v", "vgrd10m", "VGRD_10maboveground", "vwnd", "V", "va")


def read_wind(path: Path, faces: int) -> FieldData:
    read = _npz if path.suffix.lower() == ".npz" else _netcdf
    latitude, longitude, east, north = read(path)
    data = wind_on_sphere(latitude, longitude, east, north, faces, where=str(path))
    return replace(data, read=Reading((str(path),), (ArrayInfo("wind", "grid", 2),)))


def wind_on_sphere(latitude, longitude, east, north, faces: int, where: str = "the grid") -> FieldData:
    """latitude (a,), longitude (b,) in degrees; east and north (a, b) or (t, a, b)."""
    latitude, longitude = np.asarray(latitude, np.float64).ravel(), np.asarray(longitude, np.float64).ravel()
    east, north = (_stack(values, latitude, longitude, where) for values in (east, north))
    latitude, longitude, east, north = _ordered(latitude, longitude, east, north, where)
    mesh = icosphere(faces)
    vectors = np.stack([_on_sphere(mesh.vertices, latitude, longitude, u, v) for u, v in zip(east, north, strict=True)])
    return FieldData(mesh, np.linspace(0.0, 1.0, len(vectors)) if len(vectors) > 1 else np.zeros(1), vectors)


def _npz(path: Path):
    try:
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: is not an .npz file ({error})") from error
    scale = float(arrays.get("scale", 1.0))
    east, north = (_pick(arrays, names, path).astype(np.float64) * scale for names in (EAST, NORTH))
    return _pick(arrays, LATITUDE, path), _pick(arrays, LONGITUDE, path), east, north


def _netcdf(path: Path):
    import xarray

    try:
        with xarray.open_dataset(path) as data:
            arrays = {str(name): data[name] for name in data.variables}
            # A standard name identifies a variable whatever its own name is.
            meanings = {data[name].attrs.get("standard_name"): data[name] for name in data.variables}
            latitude = _meant(meanings, "latitude", arrays, LATITUDE, path)
            longitude = _meant(meanings, "longitude", arrays, LONGITUDE, path)
            east = _meant(meanings, "eastward_wind", arrays, EAST, path)
            north = _meant(meanings, "northward_wind", arrays, NORTH, path)
            places = (latitude.dims[0], longitude.dims[0])
            ordered = [wind.transpose(..., *places).values for wind in (east, north)]
            return latitude.values, longitude.values, *ordered
    except InputError:
        raise
    except Exception as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        raise InputError(f"{path}: is not a latitude-longitude grid that xarray reads ({reason})") from error


def _meant(meanings, meaning: str, arrays, names, path: Path):
    return meanings[meaning] if meaning in meanings else _pick(arrays, names, path)


def _pick(arrays, names, path: Path):
    name = next((name for name in names if name in arrays), None)
    if name is None:
        raise InputError(f"{path}: has no {' or '.join(names[:2])}; it has {', '.join(sorted(arrays))}")
    return arrays[name]


def _stack(values, latitude, longitude, where: str) -> np.ndarray:
    values = np.asarray(values, np.float64)
    shape = (len(latitude), len(longitude))
    if values.ndim < 2 or values.shape[-2:] != shape:
        raise InputError(f"{where}: wind of shape {values.shape} on a grid of {shape}; give latitude × longitude last")
    values = values.reshape(-1, *shape)
    if not np.isfinite(values).all():
        missing = np.argwhere(~np.isfinite(values))
        time, row, column = missing[0]
        raise InputError(
            f"{where}: wind is missing or not finite at {len(missing)} grid points, first at time {time}, latitude "
            f"{latitude[row]:g}, longitude {longitude[column]:g}; fill them, the whole globe is needed"
        )
    return values


def _ordered(latitude, longitude, east, north, where: str):
    """South to north, and once around from the smallest longitude in 0..360, with the whole globe covered."""
    if len(latitude) < 2 or len(longitude) < 3 or not (np.isfinite(latitude).all() and np.isfinite(longitude).all()):
        raise InputError(f"{where}: needs at least 2 latitudes and 3 longitudes, all finite")
    outside = latitude[np.abs(latitude) > 90.0 + 1e-6]
    if outside.size:
        raise InputError(f"{where}: latitude {outside[0]:g} is outside -90..90; give degrees")
    rows = np.argsort(latitude)
    # Rounding keeps 359.9999999 and -1e-7 the same meridian.
    turned = np.round(np.mod(longitude, 360.0), 6) % 360.0
    _, columns = np.unique(turned, return_index=True)
    latitude, longitude = np.clip(latitude[rows], -90.0, 90.0), turned[columns]
    steps = np.diff(np.append(longitude, longitude[0] + 360.0))
    if steps.max() > 1.5 * np.median(steps) + 1e-6:
        gap = int(np.argmax(steps))
        raise InputError(
            f"{where}: no wind between longitudes {longitude[gap]:g} and {(longitude[gap] + steps[gap]) % 360:g}; "
            "the whole globe is needed"
        )
    spacing = np.diff(latitude)
    if spacing.min() <= 0.0:
        raise InputError(f"{where}: latitude {latitude[int(np.argmin(spacing))]:g} is given twice")
    if 90.0 - np.abs(latitude[[0, -1]]).min() > 1.5 * np.median(spacing) or latitude[0] > 0 or latitude[-1] < 0:
        raise InputError(
            f"{where}: latitudes {latitude[0]:g} to {latitude[-1]:g} leave a pole uncovered; the whole globe is needed"
        )
    return latitude, longitude, east[:, rows][:, :, columns], north[:, rows][:, :, columns]


def _on_sphere(points, latitude, longitude, east, north) -> np.ndarray:
    """The tangent vectors at points of the unit sphere."""
    vectors = _in_space(latitude, longitude, east, north)
    latitude, vectors = _with_poles(latitude, vectors)
    at_latitude = np.degrees(np.arcsin(np.clip(points[:, 2], -1.0, 1.0)))
    at_longitude = np.mod(np.degrees(np.arctan2(points[:, 1], points[:, 0])) - longitude[0], 360.0) + longitude[0]
    closed = np.append(longitude, longitude[0] + 360.0)
    row = np.clip(np.searchsorted(latitude, at_latitude, side="right") - 1, 0, len(latitude) - 2)
    column = np.clip(np.searchsorted(closed, at_longitude, side="right") - 1, 0, len(closed) - 2)
    up = ((at_latitude - latitude[row]) / (latitude[row + 1] - latitude[row]))[:, None]
    along = ((at_longitude - closed[column]) / (closed[column + 1] - closed[column]))[:, None]
    after = (column + 1) % len(longitude)
    below = (1.0 - along) * vectors[row, column] + along * vectors[row, after]
    above = (1.0 - along) * vectors[row + 1, column] + along * vectors[row + 1, after]
    result = (1.0 - up) * below + up * above
    return result - np.einsum("ij,ij->i", result, points)[:, None] * points


def _in_space(latitude, longitude, east, north) -> np.ndarray:
    """(a, b, 3): u along the eastward, v along the northward unit vector."""
    phi, theta = np.radians(latitude)[:, None], np.radians(longitude)[None, :]
    eastward = np.stack(np.broadcast_arrays(-np.sin(theta), np.cos(theta), np.zeros_like(phi)), axis=-1)
    northward = np.stack(
        np.broadcast_arrays(-np.sin(phi) * np.cos(theta), -np.sin(phi) * np.sin(theta), np.cos(phi)), axis=-1
    )
    return east[..., None] * eastward + north[..., None] * northward


def _with_poles(latitude, vectors):
    """Pole rows are made equal all around, or added, as the horizontal mean of the row there or next to it."""
    for end, pole in ((0, -90.0), (-1, 90.0)):
        mean = vectors[end].mean(axis=0) * [1.0, 1.0, 0.0]
        row = np.broadcast_to(mean, vectors[end].shape)
        if abs(latitude[end] - pole) < 1e-6:
            vectors[end] = row
        else:
            at = 0 if end == 0 else len(latitude)
            latitude = np.insert(latitude, at, pole)
            vectors = np.insert(vectors, at, row, axis=0)
    return latitude, vectors
