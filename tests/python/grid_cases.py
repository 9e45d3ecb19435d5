# SPDX-License-Identifier: GPL-3.0-or-later
"""Datasets on grids of winds whose answer is known, and what is expected of them."""

import numpy as np
import pytest
import xarray
from analytic_wind import components, grid, rotation, storm
from stormfield import native
from stormfield.readers.grids import netcdf

RADIUS = 6371000.0


AXIS = np.array([3.0, -5.0, 8.0])


MS = {"units": "m s-1"}


def without_netcdf4(monkeypatch):
    pytest.importorskip("pyfive")
    monkeypatch.setattr(netcdf, "_has", lambda module: module != "netCDF4")


def field(winds, latitude, longitude, dims=("time", "latitude", "longitude"), names=("u10", "v10"), attrs=MS):
    """A dataset of winds at times; one wind has no time."""
    parts = [components(wind, latitude[:, None], longitude[None]) for wind in winds]
    u, v = (np.stack([part[k] for part in parts]) for k in (0, 1))
    if dims[0] != "time" or len(dims) == 2:
        u, v = u[0], v[0]
    coords = {dims[-2]: (dims[-2], latitude, {"units": "degrees_north"})}
    coords[dims[-1]] = (dims[-1], longitude, {"units": "degrees_east"})
    if len(dims) == 3:
        coords[dims[0]] = (dims[0], 6.0 * np.arange(len(winds)), {"units": "hours since 2018-10-06"})
    return xarray.Dataset({names[0]: (dims, u, dict(attrs)), names[1]: (dims, v, dict(attrs))}, coords)


def written(tmp_path, dataset, name="a.nc", **options):
    dataset.to_netcdf(tmp_path / name, **options)
    return tmp_path / name


def topology(data, sample=0):
    mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    return native.start_topology(native.VectorField.from_space(mesh, data.vectors[sample])).result()


def assert_is(data, wind, tolerance=0.02, sample=0):
    """The vectors are those of `wind` at the vertices, up to a share of its largest speed."""
    exact = wind(data.mesh.vertices / np.linalg.norm(data.mesh.vertices, axis=1, keepdims=True))
    difference = np.linalg.norm(data.vectors[sample] - exact, axis=1)
    assert difference.max() < tolerance * np.linalg.norm(exact, axis=1).max()


def said(data):
    return data.read.line()


LOW, HIGH = storm(25.0, 285.0), storm(30.0, 60.0)


def two_heights(order, meaning):
    latitude, longitude = grid(2.0)
    data = xarray.merge(
        [
            field([LOW], latitude, longitude, ("latitude", "longitude"), ("u10", "v10")),
            field([HIGH], latitude, longitude, ("latitude", "longitude"), ("u100", "v100")),
        ]
    )
    if meaning:
        for name in order:
            data[name].attrs["standard_name"] = "eastward_wind" if name[0] == "u" else "northward_wind"
    return data[list(order)]


ORDERS = (("u10", "u100", "v100", "v10"), ("u10", "u100", "v10", "v100"), ("v100", "u100", "v10", "u10"))


SEA = [(20.0, 40.0, 12.0), (-30.0, 200.0, 15.0), (50.0, 280.0, 8.0)]


def land(latitude, longitude):
    """(a, b) three discs of land."""
    from analytic_wind import in_space

    place = in_space(latitude[:, None], longitude[None])[0]
    result = np.zeros(place.shape[:2], bool)
    for north, east, radius in SEA:
        result |= place @ in_space(north, east)[0] > np.cos(np.radians(radius))
    return result


def with_land(latitude, longitude, value):
    data = field([rotation(AXIS)], latitude, longitude, ("latitude", "longitude"), ("uo", "vo"))
    here = land(latitude, longitude)
    for name in ("uo", "vo"):
        data[name].values[here] = value
    return data


def displaced(shape=(60, 90)):
    """A grid whose pole is not the earth's: latitude and longitude (a, b), and the direction of its rows."""
    rows, columns = np.linspace(-80, 80, shape[0]), np.arange(0, 360, 360 / shape[1])
    phi, theta = np.radians(rows)[:, None], np.radians(columns)[None]
    x, y, z = np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi) + 0 * theta
    tilt = np.radians(20.0)
    x, z = x * np.cos(tilt) + z * np.sin(tilt), z * np.cos(tilt) - x * np.sin(tilt)
    return np.degrees(np.arcsin(z)), np.degrees(np.arctan2(y, x))


def curvilinear(latitude, longitude, wind, names=("lat", "lon"), attrs=MS, coordinates=True):
    u, v = components(wind, latitude, longitude)
    data = xarray.Dataset(
        {"u": (("y", "x"), u, dict(attrs)), "v": (("y", "x"), v, dict(attrs))},
        {names[0]: (("y", "x"), latitude), names[1]: (("y", "x"), longitude)},
    )
    return data if coordinates else data.reset_coords()


def along_the_grid(latitude, longitude, u, v):
    from stormfield.readers.grids.patch import direction_of_rows

    angle = direction_of_rows(latitude, longitude)
    return u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle), angle


def wrf(winds=1, staggered=False, angles=True):
    """A region of the WRF: winds along the grid, at the sides of its cells or in their middle."""
    latitude, longitude = displaced((240, 270))
    latitude, longitude = latitude[90:111, 60:81], longitude[90:111, 60:81]

    def at(phi, theta):
        u, v = components(rotation(AXIS), phi, theta)
        return along_the_grid(phi, theta, u, v)

    middle = [0.25 * (a[1:, 1:] + a[1:, :-1] + a[:-1, 1:] + a[:-1, :-1]) for a in (latitude, longitude)]
    u, v, angle = at(*middle)
    dims = ("Time", "south_north", "west_east")
    data = {
        "U10": (dims, u[None], MS | {"description": "U at 10 M"}),
        "V10": (dims, v[None], MS | {"description": "V at 10 M"}),
    }
    if staggered:
        east = at(*(0.5 * (a[1:] + a[:-1]) for a in (latitude, longitude)))[0]
        north = at(*(0.5 * (a[:, 1:] + a[:, :-1]) for a in (latitude, longitude)))[1]
        data = {
            "U": (("Time", "bottom_top", "south_north", "west_east_stag"), np.stack([0 * east, east])[None], MS),
            "V": (("Time", "bottom_top", "south_north_stag", "west_east"), np.stack([0 * north, north])[None], MS),
        }
        for name, phi, theta in (("U", 0.5 * (latitude[1:] + latitude[:-1]), 0.5 * (longitude[1:] + longitude[:-1])),):
            data[f"XLAT_{name}"] = (("Time", "south_north", "west_east_stag"), phi[None], {"units": "degree_north"})
            data[f"XLONG_{name}"] = (("Time", "south_north", "west_east_stag"), theta[None], {"units": "degree_east"})
    data["XLAT"] = (dims, middle[0][None], {"units": "degree_north"})
    data["XLONG"] = (dims, middle[1][None], {"units": "degree_east"})
    if angles:
        data["COSALPHA"], data["SINALPHA"] = (dims, np.cos(angle)[None]), (dims, np.sin(angle)[None])
    data["Times"] = (("Time", "DateStrLen"), np.array([list("2018-10-07_06:00:00")], "S1"))
    return xarray.Dataset(data)
