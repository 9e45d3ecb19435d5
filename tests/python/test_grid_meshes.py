# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions, curvilinear, staggered and unstructured grids are the meshes that they are."""

import numpy as np
import pytest
import xarray
from analytic_wind import components, grid, rotation, storm
from grid_cases import (
    AXIS,
    MS,
    along_the_grid,
    assert_is,
    curvilinear,
    displaced,
    field,
    said,
    topology,
    with_land,
    wrf,
    written,
)
from stormfield import native
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field
from stormfield.readers.grids.patch import direction_of_rows
from stormfield.readers.grids.rotated import geographic

pytestmark = pytest.mark.usefixtures("reader")


def places(points):
    """(n, 2) latitude and longitude of fixed points."""
    position = np.array([np.asarray(point.position) for point in points]).reshape(-1, 3)
    return np.degrees(
        np.column_stack(
            [np.arctan2(position[:, 2], np.hypot(*position.T[:2])), np.arctan2(position[:, 1], position[:, 0])]
        )
    )


@pytest.mark.parametrize("step", [1, -1])
@pytest.mark.parametrize("east", [slice(260, 310), slice(0, 50), None])
def test_a_region_is_a_surface_with_boundary(tmp_path, step, east):
    latitude, longitude = np.arange(5.0, 45.5, 0.5)[::step], np.arange(260.0, 310.5, 0.5)
    wind = storm(25.0, 285.0)
    if east == slice(0, 50):  # across the Greenwich meridian, written from 0 to 360
        longitude, wind = np.concatenate([np.arange(335.0, 360.0, 0.5), np.arange(0.0, 20.5, 0.5)]), storm(25.0, 0.0)
    if east is None:  # across the date line, from -180 to 180
        longitude, wind = (
            np.concatenate([np.arange(155.0, 180.0, 0.5), np.arange(-180, -154.5, 0.5)]),
            storm(25.0, 180.0),
        )
    read = read_field(written(tmp_path, field([wind], latitude, longitude)))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.boundary_loop_count, mesh.euler_characteristic) == (1, 1)
    assert len(read.mesh.vertices) == len(latitude) * len(longitude)
    assert_is(read, wind, 1e-9)
    normal = np.cross(*(np.diff(read.mesh.vertices[read.mesh.triangles], axis=1)).transpose(1, 0, 2))
    assert (np.einsum("ij,ij->i", normal, read.mesh.vertices[read.mesh.triangles[:, 0]]) > 0).all()
    found = topology(read).fixed_points
    assert sorted(point.index for point in found) == [-1, 1]
    eye = places([point for point in found if point.index == 1])[0]
    assert abs(eye[0] - 26.1) < 0.5


def test_a_region_with_a_coast(tmp_path):
    latitude, longitude = np.arange(5.0, 46.0), np.arange(20.0, 71.0)
    data = with_land(latitude, longitude, np.nan)
    read = read_field(written(tmp_path, data))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert mesh.boundary_loop_count == 2
    assert_is(read, rotation(AXIS), 1e-9)


def test_places_where_water_meets_in_a_point_are_split(tmp_path):
    data = field([rotation(AXIS)], np.arange(5.0), np.arange(5.0), ("latitude", "longitude"))
    data.u10.values[[0, 1, 3, 4], [4, 3, 1, 0]] = np.nan
    data.u10.values[0, 3] = data.u10.values[1, 4] = data.u10.values[3, 0] = data.u10.values[4, 1] = np.nan
    read = read_field(written(tmp_path, data))
    native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    checker = field([rotation(AXIS)], np.arange(7.0), np.arange(7.0), ("latitude", "longitude"))
    checker.u10.values[3, [0, 1, 2, 4, 5, 6]] = np.nan
    read = read_field(written(tmp_path, checker, "b.nc"))
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).component_count == 2


@pytest.mark.parametrize("names", [("lat", "lon"), ("nav_lat", "nav_lon"), ("TLAT", "TLONG"), ("XLAT", "XLONG")])
@pytest.mark.parametrize("coordinates", [True, False])
def test_a_curvilinear_grid_is_the_mesh_that_it_is(tmp_path, names, coordinates):
    latitude, longitude = displaced()
    read = read_field(
        written(tmp_path, curvilinear(latitude, longitude, rotation(AXIS), names, coordinates=coordinates))
    )
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.boundary_loop_count, mesh.component_count, mesh.vertex_count) == (2, 1, latitude.size)
    assert_is(read, rotation(AXIS), 1e-9)
    assert "taken as eastward and northward" in said(read)


def test_a_curvilinear_grid_with_repeated_columns_is_welded(tmp_path):
    latitude, longitude = (np.concatenate([values, values[:, :2]], axis=1) for values in displaced())
    read = read_field(written(tmp_path, curvilinear(latitude, longitude, rotation(AXIS))))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.boundary_loop_count, mesh.component_count, mesh.vertex_count) == (2, 1, 60 * 90)
    assert "120 repeated grid points welded" in said(read)


def test_two_dimensional_coordinates_of_rows_and_columns_are_a_globe(tmp_path):
    latitude, longitude = grid(3.0)
    theta, phi = np.meshgrid(longitude, latitude)
    read = read_field(written(tmp_path, curvilinear(phi, theta, rotation(AXIS))))
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).boundary_loop_count == 0
    assert_is(read, rotation(AXIS))


def test_components_that_follow_the_grid_are_turned(tmp_path):
    latitude, longitude = displaced()
    latitude, longitude = latitude[:, 10:50], longitude[:, 10:50]
    u, v = components(rotation(AXIS), latitude, longitude)
    u, v, _ = along_the_grid(latitude, longitude, u, v)
    data = curvilinear(latitude, longitude, rotation(AXIS))
    data["u"] = (("y", "x"), u, MS | {"standard_name": "sea_water_x_velocity"})
    data["v"] = (("y", "x"), v, MS | {"standard_name": "sea_water_y_velocity"})
    read = read_field(written(tmp_path, data))
    assert_is(read, rotation(AXIS), 1e-6)
    assert "turned by the direction of its rows" in said(read)


@pytest.mark.parametrize("staggered", [False, True])
def test_winds_of_the_wrf(tmp_path, staggered):
    path = written(tmp_path, wrf(staggered=staggered))
    if staggered:
        with pytest.raises(InputError, match=r"2 values of bottom_top .*--level"):
            read_field(path)
    read = read_field(path, Choice(level="1") if staggered else None)
    assert_is(read, rotation(AXIS), 2e-3 if staggered else 1e-9)
    assert "COSALPHA" in said(read)
    assert read.read.times == ("2018-10-07T06:00:00",)
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).euler_characteristic == 1


def test_a_grid_that_moves_is_refused(tmp_path):
    data = xarray.concat([wrf(), wrf()], "Time")
    data.XLAT.values[1] += 1.0
    data["Times"] = (("Time", "DateStrLen"), np.array([list("2018-10-07_06:00:00"), list("2018-10-07_12:00:00")], "S1"))
    with pytest.raises(InputError, match="the grid moves"):
        read_field(written(tmp_path, data))


def test_components_at_different_places_are_refused(tmp_path):
    latitude, longitude = displaced()
    data = curvilinear(latitude, longitude, rotation(AXIS), ("nav_lat_U", "nav_lon_U"))
    data = data.assign_coords(nav_lat_V=(("y", "x"), latitude + 0.5), nav_lon_V=(("y", "x"), longitude))
    for name in ("nav_lat_U", "nav_lat_V"):
        data[name].attrs["units"] = "degrees_north"
    for name in ("nav_lon_U", "nav_lon_V"):
        data[name].attrs["units"] = "degrees_east"
    data.u.encoding["coordinates"], data.v.encoding["coordinates"] = "nav_lat_U nav_lon_U", "nav_lat_V nav_lon_V"
    with pytest.raises(InputError, match="staggered"):
        read_field(written(tmp_path, data))


def test_coordinates_of_a_projection_alone_are_refused(tmp_path):
    data = field([rotation(AXIS)], np.arange(5.0), np.arange(6.0), ("y", "x"))
    data["y"], data["x"] = (
        (("y",), 1e4 * np.arange(5.0), {"units": "m"}),
        (("x",), 1e4 * np.arange(6.0), {"units": "m"}),
    )
    for name in ("u10", "v10"):
        data[name].attrs["standard_name"] = "eastward_wind" if name[0] == "u" else "northward_wind"
    with pytest.raises(InputError, match="no latitude and longitude, only the x and y of a projection"):
        read_field(written(tmp_path, data))
    for name in ("u10", "v10"):
        del data[name].attrs["standard_name"]
    read = read_field(written(tmp_path, data, "b.nc"))
    assert "a plane" in said(read)
    assert np.ptp(read.mesh.vertices, axis=0).tolist() == [5e4, 4e4, 0.0]


def ugrid(location, start=0, quads=False):
    from stormfield.readers.icosphere import icosphere

    sphere = icosphere(1280)
    places_ = np.degrees(
        np.column_stack([np.arctan2(sphere.vertices[:, 1], sphere.vertices[:, 0]), np.arcsin(sphere.vertices[:, 2])])
    )
    middle = sphere.vertices[sphere.triangles].mean(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    at = sphere.vertices if location == "node" else middle
    u, v = components(rotation(AXIS), np.degrees(np.arcsin(at[:, 2])), np.degrees(np.arctan2(at[:, 1], at[:, 0])))
    corners = sphere.triangles + start
    if quads:
        corners = np.column_stack([corners, np.full(len(corners), -1)])
    attrs = MS | {"mesh": "Mesh2", "location": location}
    mesh = {
        "cf_role": "mesh_topology",
        "topology_dimension": 2,
        "node_coordinates": "Mesh2_node_x Mesh2_node_y",
        "face_node_connectivity": "Mesh2_face_nodes",
    }
    dim = f"nMesh2_{location}"
    return xarray.Dataset(
        {
            "Mesh2": ((), 0, mesh),
            "Mesh2_face_nodes": (("nMesh2_face", "three"), corners, {"start_index": start}),
            "Mesh2_node_x": ("nMesh2_node", places_[:, 0], {"units": "degrees_east"}),
            "Mesh2_node_y": ("nMesh2_node", places_[:, 1], {"units": "degrees_north"}),
            "u": (dim, u, attrs),
            "v": (dim, v, attrs),
        }
    )


@pytest.mark.parametrize("location", ["node", "face"])
@pytest.mark.parametrize(("start", "quads"), [(0, False), (1, False), (1, True)])
def test_an_unstructured_grid_is_the_mesh_that_it_is(tmp_path, location, start, quads):
    read = read_field(written(tmp_path, ugrid(location, start, quads)))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.face_count, mesh.boundary_loop_count, mesh.euler_characteristic) == (1280, 0, 2)
    assert_is(read, rotation(AXIS), 1e-9 if location == "node" else 0.01)
    assert ("averaged" in said(read)) == (location == "face")


def test_vectors_on_edges_are_refused(tmp_path):
    data = ugrid("node")
    data["u"], data["v"] = (
        (("nMesh2_edge",), np.ones(1920), data.u.attrs),
        (("nMesh2_edge",), np.ones(1920), data.v.attrs),
    )
    with pytest.raises(InputError, match="edges"):
        read_field(written(tmp_path, data))


def test_cells_with_corners_and_radians(tmp_path):
    """As ICON writes it: clat and clon in radians with their vertices."""
    data = ugrid("face")
    corners = data.Mesh2_face_nodes.values
    lon, lat = np.radians(data.Mesh2_node_x.values)[corners], np.radians(data.Mesh2_node_y.values)[corners]
    from stormfield.readers.icosphere import icosphere

    sphere = icosphere(1280)
    middle = sphere.vertices[sphere.triangles].mean(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    icon = xarray.Dataset(
        {"u": ("ncells", data.u.values, MS), "v": ("ncells", data.v.values, MS)},
        {
            "clat": (
                "ncells",
                np.arcsin(middle[:, 2]),
                {"units": "radian", "standard_name": "latitude", "bounds": "clat_vertices"},
            ),
            "clon": (
                "ncells",
                np.arctan2(middle[:, 1], middle[:, 0]),
                {"units": "radian", "standard_name": "longitude", "bounds": "clon_vertices"},
            ),
            "clat_vertices": (("ncells", "vertices"), lat),
            "clon_vertices": (("ncells", "vertices"), lon),
        },
    )
    read = read_field(written(tmp_path, icon))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.face_count, mesh.boundary_loop_count) == (1280, 0)
    assert_is(read, rotation(AXIS), 0.01)


def test_scattered_places_are_triangulated(tmp_path):
    data = ugrid("node").drop_vars(["Mesh2", "Mesh2_face_nodes"]).rename(Mesh2_node_x="lon", Mesh2_node_y="lat")
    for name in ("u", "v"):
        data[name].attrs = dict(MS)
    read = read_field(written(tmp_path, data))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.face_count, mesh.boundary_loop_count) == (1280, 0)
    assert_is(read, rotation(AXIS), 1e-9)
    assert "Delaunay" in said(read)
    half = data.isel(nMesh2_node=np.flatnonzero(data.lat.values > 10.0))
    read = read_field(written(tmp_path, half, "b.nc"))
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).boundary_loop_count == 1


@pytest.mark.parametrize("axes", ["of the grid", "called latitude and longitude"])
@pytest.mark.parametrize("follow", [True, False])
def test_rows_and_columns_about_a_rotated_pole_are_places_of_the_earth(tmp_path, axes, follow):
    """A storm at 50 N 10 E on the grid of a regional model, whose own coordinates have it at 0, −5."""
    rows, columns = np.arange(-12.0, 13.0), np.arange(-20.0, 11.0)
    latitude, longitude = geographic(rows[:, None], columns[None], 39.25, -162.0)
    u, v = components(storm(50.0, 10.0, radius=0.08, westerly=0.0), latitude, longitude)
    if follow:
        turn = direction_of_rows(latitude, longitude)
        u, v = np.cos(turn) * u + np.sin(turn) * v, np.cos(turn) * v - np.sin(turn) * u
    units = ("degrees", "degrees") if axes == "of the grid" else ("degrees_north", "degrees_east")
    names = ("x_wind", "y_wind") if follow else ("eastward_wind", "northward_wind")
    mapping = {
        "grid_mapping_name": "rotated_latitude_longitude",
        "grid_north_pole_latitude": 39.25,
        "grid_north_pole_longitude": -162.0,
    }
    dataset = xarray.Dataset(
        {
            name: (("rlat", "rlon"), values, {**MS, "standard_name": meaning, "grid_mapping": "pole"})
            for name, values, meaning in zip("uv", (u, v), names, strict=True)
        },
        {"rlat": ("rlat", rows, {"units": units[0]}), "rlon": ("rlon", columns, {"units": units[1]})},
    ).assign(pole=xarray.DataArray(0, attrs=mapping))
    data = read_field(written(tmp_path, dataset))
    eye = min(topology(data).fixed_points, key=lambda point: np.abs(places([point])[0] - (50.0, 10.0)).sum())
    assert np.abs(places([eye])[0] - (50.0, 10.0)).max() < 0.2
    assert "rotated pole" in said(data)
    del dataset.pole.attrs["grid_north_pole_latitude"]
    with pytest.raises(InputError, match="lacks grid_north_pole_latitude"):
        read_field(written(tmp_path, dataset, "b.nc"))


def test_places_about_the_pole_of_the_earth_are_those_of_the_earth():
    latitude, longitude = np.meshgrid([-60.0, 0.0, 45.0], [-150.0, 0.0, 30.0], indexing="ij")
    found = geographic(latitude, longitude, 90.0, 180.0)
    assert np.allclose(found[0], latitude) and np.allclose(np.mod(found[1] - longitude + 1.0, 360.0), 1.0)
