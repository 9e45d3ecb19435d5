# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the values of a pair lie: its horizontal dimensions, and the grid that they make."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...model.errors import InputError
from .components import Pair, unstaggered
from .globe import Globe, is_around
from .patch import Patch, Plane, direction_of_rows
from .rotated import rotated_axes
from .surface import Grid
from .ugrid import mesh_of
from .unstructured import cells_with_bounds, scattered
from .vocabulary import attributes, is_latitude, is_longitude, unit

LENGTHS = {"m", "km", "meter", "metre", "meters", "metres", "kilometers", "kilometres"}
#: Angles between rows and parallels that matter where nothing says along what u and v point.
TURNED = np.radians(1.0)


def find_grid(dataset, pair: Pair, where: str) -> Grid:
    """The grid of a pair of variables. Raises InputError with the cure where there is none."""
    east, north = dataset[pair.east], dataset[pair.north]
    own = [sorted(_said_coordinates(variable)) for variable in (east, north)]
    if all(own) and east.dims == north.dims and own[0] != own[1] and _horizontal_differs(dataset, *own):
        raise InputError(
            f"{where}: {pair.east} lies at {', '.join(own[0])} and {pair.north} at {', '.join(own[1])}: a staggered "
            "grid; bring both to the middle of its cells first"
        )
    mesh = mesh_of(dataset, east, where)
    if mesh is not None:
        return mesh
    rotated = rotated_axes(dataset, east, where)
    if rotated is not None:
        return _rotated(*rotated, pair)
    found = _latitude_longitude(dataset, east, north)
    if found is None:
        return _plane(dataset, pair, where)
    latitude, longitude = (_degrees(_steady(dataset[name], where)) for name in found)
    if latitude.ndim == 1 and latitude.dims != longitude.dims:
        return _rows_and_columns(latitude, longitude, east, where)
    if latitude.dims != longitude.dims or latitude.ndim > 2:
        raise InputError(
            f"{where}: latitude has dimensions {', '.join(latitude.dims)} and longitude {', '.join(longitude.dims)}; "
            "give both one dimension each, or the same ones"
        )
    if latitude.ndim == 0:
        raise InputError(f"{where}: {pair.names} lie at one place; give a grid")
    if latitude.ndim == 1:
        return _places(dataset, latitude, longitude, where)
    return _curvilinear(dataset, pair, latitude, longitude, where)


def _rows_and_columns(latitude, longitude, variable, where: str) -> Grid:
    for name, axis, least in (("latitude", latitude, 2), ("longitude", longitude, 2)):
        if axis.size < least or not np.isfinite(axis.values).all():
            raise InputError(f"{where}: needs at least {least} values of {name}, all finite")
    _check_latitude(latitude.values, where)
    values = latitude.values
    if len(np.unique(np.round(values, 9))) < len(values):
        twice = next(value for i, value in enumerate(values) if np.isclose(values[:i], value, rtol=0, atol=1e-9).any())
        raise InputError(f"{where}: latitude {twice:g} is given twice")
    dims = (latitude.dims[0], longitude.dims[0])
    if is_around(longitude.values):
        return Globe(latitude.values, longitude.values, dims, where)
    notes = (f"a region, {_range(values)}° N, {_range(longitude.values)}° E, that ends at the border of the grid",)
    theta, phi = np.meshgrid(np.sort(longitude.values), np.sort(values))
    # Rows and columns as they are in the file; the mesh needs no order.
    theta, phi = np.meshgrid(longitude.values, values)
    return Patch(phi, theta, dims, None, notes)


def _rotated(rows, columns, phi: np.ndarray, theta: np.ndarray, pair: Pair) -> Grid:
    turn, notes = _turn(None, pair, phi, theta)
    note = f"{rows.name} and {columns.name} are about a rotated pole, places on the earth computed from it"
    return Patch(phi, theta, (str(rows.dims[0]), str(columns.dims[0])), turn, (note, *notes))


def _curvilinear(dataset, pair: Pair, latitude, longitude, where: str) -> Grid:
    phi, theta = latitude.values, longitude.values
    missing = ~(np.isfinite(phi) & np.isfinite(theta)) | (np.abs(phi) > 1e10) | (np.abs(theta) > 1e10)
    # Places without a position are written as 0, 0 by models that leave out processors of land.
    zero = (phi == 0.0) & (theta == 0.0)
    if zero.sum() > 1:
        missing |= zero
    phi, theta = np.where(missing, np.nan, phi), np.where(missing, np.nan, theta)
    _check_latitude(phi[~missing], where)
    dims = latitude.dims
    inner = _inner(dataset, pair, latitude)
    phi, theta, missing = phi[inner], theta[inner], missing[inner]
    if not missing.any() and _is_straight(phi, axis=1) and _is_straight(np.mod(theta, 360.0), axis=0):
        rows, columns = latitude[inner].copy(data=phi)[:, 0], longitude[inner].copy(data=theta)[0]
        return _rows_and_columns(rows, columns, dataset[pair.east], where)
    turn, notes = _turn(_angle(dataset, dims, inner), pair, phi, theta)
    return Patch(phi, theta, dims, turn, notes)


def _inner(dataset, pair: Pair, latitude) -> tuple[slice, slice]:
    """The cells around which a staggered grid has both components: all, or all but those at its border."""
    x = str(dataset[pair.east].dims[-1])
    if x != dataset[pair.north].dims[-1] and dataset.sizes[x] == latitude.shape[1] - 1:
        return slice(1, -1), slice(1, -1)
    return slice(None), slice(None)


def _turn(given: tuple[np.ndarray, str] | None, pair: Pair, phi, theta) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """The angle of the first component to the east, and what is to be said of it. given: angles of the file."""
    if pair.frame == "earth":
        return None, ()
    follow = f"{pair.names} follow the grid and are turned"
    if given is not None:
        return given[0], (f"{follow} to the east by {given[1]}",)
    if pair.frame == "grid":
        return direction_of_rows(phi, theta), (f"{follow} by the direction of its rows",)
    along = direction_of_rows(phi, theta)
    if np.nanmedian(np.abs(along)) < TURNED:
        return None, ()
    return None, (
        f"nothing says whether {pair.names} point along the grid: they are taken as eastward and northward; "
        "where they follow the grid, set the standard names x_wind and y_wind",
    )


def _angle(dataset, dims, inner: tuple[slice, slice]) -> tuple[np.ndarray, str] | None:
    """The angle between rows and east that a file gives itself."""
    names = {str(name).lower(): str(name) for name in dataset.variables}
    if "cosalpha" in names and "sinalpha" in names:
        cosine, sine = (_last(dataset[names[name]], dims, inner) for name in ("cosalpha", "sinalpha"))
        if cosine is not None and sine is not None:
            return np.arctan2(sine, cosine), f"{names['cosalpha']} and {names['sinalpha']}"
    for name in ("angle", "anglet"):
        values = _last(dataset[names[name]], dims, inner) if name in names else None
        if values is not None:
            degrees = "deg" in unit(dataset[names[name]]).lower()
            return np.radians(values) if degrees else values, names[name]
    return None


def _last(variable, dims, inner: tuple[slice, slice]) -> np.ndarray | None:
    """The values on the horizontal dimensions, of the first time."""
    if not set(dims) <= set(variable.dims):
        return None
    first = variable.isel({dim: 0 for dim in variable.dims if dim not in dims}).transpose(*dims)
    return first.values.astype(np.float64)[inner]


def _places(dataset, latitude, longitude, where: str) -> Grid:
    """Values at single places: cells whose corners are known, or scattered."""
    places = np.column_stack([np.mod(longitude.values + 180.0, 360.0) - 180.0, latitude.values])
    _check_latitude(latitude.values, where)
    bounds = [_bounds(dataset, variable, word) for variable, word in ((longitude, "lon"), (latitude, "lat"))]
    dims = (str(latitude.dims[0]),)
    corners = [bound for bound in bounds if bound is not None and bound.ndim == 2 and bound.shape[1] >= 3]
    if len(corners) == 2:
        return cells_with_bounds(places, np.stack(corners, axis=2), dims)
    finite = np.isfinite(places).all(axis=1)
    if not finite.all():
        raise InputError(f"{where}: {int((~finite).sum())} of {len(finite)} places have no position; leave them out")
    return scattered(places, dims, where)


def _bounds(dataset, variable, word: str) -> np.ndarray | None:
    name = attributes(variable).get("bounds") or f"c{word}_vertices"
    if name not in dataset.variables or dataset[name].dims[:1] != variable.dims:
        return None
    values = dataset[name].values.astype(np.float64)
    return (
        np.degrees(values)
        if _is_radian(dataset[name]) or (_is_radian(variable) and not unit(dataset[name]))
        else values
    )


def _latitude_longitude(dataset, east, north) -> tuple[str, str] | None:
    """Names of the latitude and longitude of both: those that the variable names first, then of few dimensions."""
    dims = {*east.dims, *north.dims}
    shared = set(east.dims) & set(north.dims)
    own = _said_coordinates(east)

    def candidates(test) -> Iterator[str]:
        names = [str(name) for name in dataset.variables if test(str(name), dataset[name])]
        names = [name for name in names if dataset[name].ndim and _lies_on(dataset[name], dims)]
        if east.dims == north.dims:
            names = [name for name in names if _is_on(dataset[name], east)]
            order = sorted(names, key=lambda name: (name not in own, dataset[name].ndim, name not in shared))
        else:  # a staggered grid: the middle of its cells lies on dimensions of both
            order = sorted(names, key=lambda name: _is_on(dataset[name], east) or _is_on(dataset[name], north))
            order = [
                name for name in order if not (_is_on(dataset[name], east) or _is_on(dataset[name], north))
            ] or order
        yield from order

    for latitude in candidates(is_latitude):
        for longitude in candidates(is_longitude):
            both = set(dataset[latitude].dims) | set(dataset[longitude].dims)
            if dataset[latitude].ndim == dataset[longitude].ndim and (
                len(both) == 2 * dataset[latitude].ndim or dataset[latitude].dims == dataset[longitude].dims
            ):
                return latitude, longitude
    return None


def _lies_on(coordinate, dims: set) -> bool:
    """Whether a coordinate has dimensions of a pair only, or those of the middle of its cells."""
    return {unstaggered(dim) for dim in coordinate.dims} <= {unstaggered(dim) for dim in dims}


def _is_on(coordinate, variable) -> bool:
    """Whether a coordinate lies on the horizontal dimensions of one component of a staggered grid."""
    return set(coordinate.dims) <= set(variable.dims)


def _said_coordinates(variable) -> set[str]:
    """Names in the attribute `coordinates`, which xarray moves to the encoding."""
    return set(str(attributes(variable).get("coordinates", "")).split()) & set(map(str, variable.coords))


def _horizontal_differs(dataset, east: list[str], north: list[str]) -> bool:
    """Whether two sets of coordinates hold different places."""
    for test in (is_latitude, is_longitude):
        pair = [next((name for name in names if test(name, dataset[name])), None) for names in (east, north)]
        if (
            None not in pair
            and pair[0] != pair[1]
            and not np.array_equal(dataset[pair[0]].values, dataset[pair[1]].values)
        ):
            return True
    return False


def _plane(dataset, pair: Pair, where: str) -> Grid:
    """Rows and columns in lengths, for data that have no place on the earth."""
    variable = dataset[pair.east]
    axes = [str(dim) for dim in variable.dims[-2:] if dim in dataset.variables and unit(dataset[str(dim)]) in LENGTHS]
    if len(axes) == 2 and pair.frame != "earth" and not attributes(variable).get("grid_mapping"):
        y, x = axes if not axes[0].lower().startswith("x") else axes[::-1]
        scale = [1000.0 if unit(dataset[axis]).startswith("k") else 1.0 for axis in (x, y)]
        note = "rows and columns are in metres: a plane, not a sphere"
        across, up = (dataset[axis].values.astype(np.float64) * k for axis, k in zip((x, y), scale, strict=True))
        return Plane(across, up, (y, x), (note,))
    named = [str(name) for name in dataset.variables if str(name) not in (pair.east, pair.north)]
    projected = ", only the x and y of a projection" if len(axes) == 2 else ""
    raise InputError(
        f"{where}: {pair.names} have no latitude and longitude{projected}; it has "
        f"{', '.join(named) or 'nothing else'}; add them as variables with the units degrees_north and degrees_east"
    )


def _steady(variable, where: str):
    """A coordinate without time: the first, where it never changes."""
    extra = [dim for dim in variable.dims if variable.ndim > 2 or str(dim).lower() in ("time", "valid_time")]
    if not extra or variable.ndim == 1:
        return variable
    first = variable.isel({extra[0]: 0})
    last = variable.isel({extra[0]: -1})
    if not np.allclose(first.values, last.values, equal_nan=True):
        raise InputError(
            f"{where}: {variable.name} changes over {extra[0]}: the grid moves; put it onto one that stays"
        )
    return _steady(first, where) if first.ndim > 2 else first


def _degrees(variable):
    values = variable.astype(np.float64)
    return values.copy(data=np.degrees(values.values)) if _is_radian(variable) else values


def _is_radian(variable) -> bool:
    return unit(variable).lower() in ("radian", "radians", "rad")


def _is_straight(values: np.ndarray, axis: int) -> bool:
    """Whether values do not change along an axis."""
    first = np.take(values, [0], axis=axis)
    difference = np.abs(values - first)
    return bool(np.minimum(difference, 360.0 - difference).max() < 1e-4)


def _check_latitude(latitude: np.ndarray, where: str) -> None:
    outside = latitude[np.abs(latitude) > 90.0 + 1e-4]
    if outside.size:
        raise InputError(f"{where}: latitude {outside[0]:g} is outside -90..90; give degrees")


def _range(values: np.ndarray) -> str:
    return f"{values.min():g} to {values.max():g}"
