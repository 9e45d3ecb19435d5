# SPDX-License-Identifier: GPL-3.0-or-later
"""Wind and currents on grids: winds whose answer is known, as the models write them, and what is refused in words."""

import cftime
import numpy as np
import pytest
import xarray
from analytic_wind import components, grid, rotation, storm
from stormfield import native
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field, read_mesh
from stormfield.readers.grids import components as pairs
from stormfield.readers.grids import netcdf
from stormfield.readers.grids.vocabulary import speed_of

RADIUS = 6371000.0
AXIS = np.array([3.0, -5.0, 8.0])
MS = {"units": "m s-1"}


@pytest.fixture(autouse=True, params=["netCDF4", "without netCDF4"])
def reader(request, monkeypatch):
    """Blender has no netCDF4: all that is read with it is read without it too."""
    if request.param != "netCDF4":
        without_netcdf4(monkeypatch)


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


def places(points):
    """(n, 2) latitude and longitude of fixed points."""
    position = np.array([np.asarray(point.position) for point in points]).reshape(-1, 3)
    return np.degrees(
        np.column_stack(
            [np.arctan2(position[:, 2], np.hypot(*position.T[:2])), np.arctan2(position[:, 1], position[:, 0])]
        )
    )


def assert_is(data, wind, tolerance=0.02, sample=0):
    """The vectors are those of `wind` at the vertices, up to a share of its largest speed."""
    exact = wind(data.mesh.vertices / np.linalg.norm(data.mesh.vertices, axis=1, keepdims=True))
    difference = np.linalg.norm(data.vectors[sample] - exact, axis=1)
    assert difference.max() < tolerance * np.linalg.norm(exact, axis=1).max()


def said(data):
    return data.read.line()


# The globe ------------------------------------------------------------------------------------------------------------

GRIDS = {
    "pole rows, from 0": (np.arange(-90.0, 91, 3), np.arange(0.0, 360, 3)),
    "north first, from -180": (np.arange(90.0, -91, -3), np.arange(-180.0, 180, 3)),
    "no pole rows": (np.arange(-88.5, 89, 3), np.arange(1.5, 360, 3)),
    "starts anywhere, closes": (np.arange(-90.0, 91, 3), np.arange(123.0, 484, 3)),
    "half the rows at one pole": (np.arange(-90.0, 89, 3), np.arange(-60.0, 300, 3)),
}


@pytest.mark.parametrize("name", GRIDS)
def test_a_rigid_rotation_arrives_wherever_the_grid_starts(tmp_path, name):
    path = written(tmp_path, field([rotation(AXIS)], *GRIDS[name], dims=("latitude", "longitude")))
    data = read_field(path, Choice(sphere_faces=2000))
    assert_is(data, rotation(AXIS), 0.003)
    normal = data.mesh.vertices / RADIUS
    assert np.abs(np.einsum("ij,ij->i", data.vectors[0], normal)).max() < 1e-9
    assert len(data.mesh.vertices) == len(data.mesh.triangles) // 2 + 2


def test_lengths_are_metres_so_that_rates_and_periods_are_of_seconds(tmp_path):
    """A rotation of 11.4 m/s at its equator takes 3.51e6 s and turns by 3.6e-6 1/s."""
    path = written(tmp_path, field([rotation(np.array([0, 0, 11.4]))], *grid(3.0), dims=("latitude", "longitude")))
    data = read_field(path, Choice(sphere_faces=5120))
    assert np.allclose(np.linalg.norm(data.mesh.vertices, axis=1), RADIUS)
    found = topology(data)
    assert len(found.fixed_points) == 2
    assert np.abs([point.rotation for point in found.fixed_points]) == pytest.approx(2 * 11.4 / RADIUS, rel=0.01)
    mars = read_field(path, Choice(sphere_faces=5120, radius_km=3389.5))
    assert np.allclose(np.linalg.norm(mars.mesh.vertices, axis=1), 3389500.0)
    assert "radius 3389.5 km" in said(mars)


@pytest.mark.parametrize("radius", [0.0, -1.0, 6371000.0, np.nan])
def test_a_radius_in_other_units_is_refused(radius):
    with pytest.raises(InputError, match="kilometres"):
        Choice(radius_km=radius)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("m s**-1", 1), ("m/s", 1), ("meters per second", 1), ("cm/s", 0.01), ("knots", 0.514444), ("km h-1", 1 / 3.6)]  # noqa: RUF005
    + [("m.s-1", 1), ("metre second-1", 1), ("m s^-1", 1), ("kt", 0.514444), ("km/day", 1000 / 86400)],
)
def test_units_of_speed(tmp_path, unit, factor):
    assert speed_of(unit) == pytest.approx(factor, rel=1e-4)
    data = field([rotation(AXIS / factor)], *grid(10.0), dims=("latitude", "longitude"), attrs={"units": unit})
    read = read_field(written(tmp_path, data))
    assert_is(read, rotation(AXIS), 0.03)
    assert ("converted" in said(read)) == (factor != 1)


@pytest.mark.parametrize("unit", ["N m-2", "Pa", "K", "m", "s-1", "1", "m2 s-2", "m s", "kg m s-1"])
def test_units_that_are_no_speed(unit):
    assert speed_of(unit) is None


def test_resolution_follows_the_data(tmp_path):
    """A storm of a quarter of the default sphere's edge is one storm, not fragments (0.5° grid, radius 1.2°)."""
    latitude, longitude = grid(0.5)
    small = storm(25.0, 285.0, radius=np.radians(1.2))
    path = written(tmp_path, field([small], latitude, longitude, dims=("latitude", "longitude")))
    data = read_field(path)
    assert 3.5e5 < len(data.mesh.triangles) < 4.1e5
    found = topology(data)
    assert sorted(point.index for point in found.fixed_points) == [-1, 1, 1, 1]
    coarse = read_field(path, Choice(sphere_faces=20480))
    assert "which is finer" in said(coarse)
    assert "which is finer" not in said(data)


# Poles ----------------------------------------------------------------------------------------------------------------


def repeated_components(u, v):
    u[0], v[0], u[-1], v[-1] = u[0, 0], v[0, 0], u[-1, 0], v[-1, 0]


def zeros(u, v):
    for values in (u, v):
        values[0] = values[-1] = 0.0


def missing(u, v):
    for values in (u, v):
        values[0] = values[-1] = np.nan


@pytest.mark.parametrize("spoil", [repeated_components, zeros, missing])
def test_a_pole_row_that_is_no_vector_is_not_used(tmp_path, spoil):
    """The wind over the pole is 11.4 m/s, not zero."""
    data = field([rotation(np.array([11.4, 0, 0]))], *grid(1.0), dims=("latitude", "longitude"))
    spoil(data.u10.values, data.v10.values)
    read = read_field(written(tmp_path, data), Choice(sphere_faces=20480))
    assert_is(read, rotation(np.array([11.4, 0, 0])), 0.002)
    assert len(read.mesh.vertices) == len(read.mesh.triangles) // 2 + 2
    assert len(topology(read).fixed_points) == 2
    if spoil is not missing:
        assert "pole is not one vector" in said(read)


@pytest.mark.parametrize("wind", [rotation(AXIS), rotation(np.array([0, 0, 10.0])), storm(88.0, 30.0)])
def test_a_pole_row_that_is_one_vector_is_used_without_a_word(tmp_path, wind):
    read = read_field(written(tmp_path, field([wind], *grid(1.0), dims=("latitude", "longitude"))))
    assert " pole " not in said(read)
    assert_is(read, wind)


# Which u and v --------------------------------------------------------------------------------------------------------

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


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("meaning", [False, True])
def test_u_and_v_are_never_mixed(tmp_path, order, meaning):
    path = written(tmp_path, two_heights(order, meaning))
    data = read_field(path)
    assert_is(data, LOW, 0.1)
    assert "other vectors to choose: u100,v100" in said(data)
    for vector in ("u100,v100", "u100", " u100 , v100 "):
        data = read_field(path, Choice(vector=vector))
        assert_is(data, HIGH, 0.1)
        assert [array.name for array in data.read.arrays] == ["u100", "v100"]


@pytest.mark.parametrize(
    ("vector", "words"),
    [
        ("nonsense", "has no variable 'nonsense'; choose from"),
        ("u10,nonsense", "has no variable 'nonsense'"),
        ("v10,u10", "write --vector u10,v10"),
        ("u10,v100", "are of two vectors; choose one of: u10,v10; u100,v100"),
    ],
)
def test_what_vector_cannot_be_is_refused(tmp_path, vector, words):
    with pytest.raises(InputError, match=words):
        read_field(written(tmp_path, two_heights(ORDERS[0], False)), Choice(vector=vector))


MODELS = {
    "NCAR RDA": ("VAR_10U", "VAR_10V", {"units": "m s**-1"}),
    "MERRA-2": ("U10M", "V10M", {"units": "m s-1", "long_name": "10-meter_eastward_wind"}),
    "HYCOM": ("water_u", "water_v", {"units": "m/s"}),
    "WeatherBench": ("10m_u_component_of_wind", "10m_v_component_of_wind", {}),
    "AVISO": ("ugos", "vgos", {"units": "m/s"}),
    "CMEMS": ("uo", "vo", {"units": "m s-1"}),
    "stress": ("taux", "tauy", {"units": "N m-2"}),
    "CMIP": ("uas", "vas", {"units": "m s-1"}),
    "CMIP levels": ("ua", "va", {"units": "m s-1"}),
    "NCEP": ("uwnd", "vwnd", {"units": "m/s"}),
    "wgrib2": ("UGRD_10maboveground", "VGRD_10maboveground", {"units": "m/s"}),
    "THREDDS": ("u-component_of_wind_height_above_ground", "v-component_of_wind_height_above_ground", {"units": "m/s"}),
    "ICON": ("u_10m", "v_10m", {"units": "m s-1"}),
    "words": ("zonal_wind", "meridional_wind", {"units": "m s-1"}),
    "CCMP": ("uwnd", "vwnd", {"units": "m s-1"}),
    "SODA": ("UVEL", "VVEL", {"units": "centimeter/s"}),
    "OSCAR": ("u", "v", {"units": "meter/sec"}),
    "wave": ("eastward_current", "northward_current", {"units": "m s-1"}),
    "ascat": ("eastward_wind", "northward_wind", {"units": "m s-1"}),
}


@pytest.mark.parametrize("model", MODELS)
def test_names_of_models(tmp_path, model):
    east, north, attrs = MODELS[model]
    factor = speed_of(attrs.get("units", "")) or 1.0
    wind = rotation(AXIS / factor)
    data = field([wind], *grid(5.0), dims=("latitude", "longitude"), names=(east, north), attrs=attrs)
    data["speed"] = np.hypot(data[east], data[north])
    data["t2m"] = data["speed"] + 273.0
    read = read_field(written(tmp_path, data))
    assert [array.name for array in read.read.arrays] == [east, north]
    assert_is(read, rotation(AXIS))
    if not attrs.get("units"):
        assert "no unit" in said(read)
    if attrs.get("units") == "N m-2":
        assert "N m-2 is no speed" in said(read)


MEANINGS = [
    ("eastward_wind", "northward_wind"),
    ("eastward_sea_water_velocity", "northward_sea_water_velocity"),
    ("surface_geostrophic_eastward_sea_water_velocity", "surface_geostrophic_northward_sea_water_velocity"),
    ("x_wind", "y_wind"),
    ("sea_water_x_velocity", "sea_water_y_velocity"),
    ("eastward_sea_ice_velocity", "northward_sea_ice_velocity"),
    ("surface_downward_eastward_stress", "surface_downward_northward_stress"),
    ("sea_surface_wave_stokes_drift_x_velocity", "sea_surface_wave_stokes_drift_y_velocity"),
]


@pytest.mark.parametrize("meaning", MEANINGS)
def test_meanings_count_whatever_the_names_are(tmp_path, meaning):
    """Also against names that say the contrary, and on axes of any name and order."""
    latitude, longitude = grid(5.0)
    u, v = components(rotation(AXIS), latitude[:, None], longitude[None])
    data = xarray.Dataset(
        {
            "v": (("b", "a"), u.T, {"standard_name": meaning[0], "units": "m s-1"}),
            "u": (("b", "a"), v.T, {"standard_name": meaning[1], "units": "m s-1"}),
        },
        {"a": ("a", latitude, {"standard_name": "latitude"}), "b": ("b", longitude, {"standard_name": "longitude"})},
    )
    read = read_field(written(tmp_path, data))
    assert [array.name for array in read.read.arrays] == ["v", "u"]
    assert_is(read, rotation(AXIS))


def test_meanings_that_leave_a_choice_open_are_refused(tmp_path):
    latitude, longitude = grid(10.0)
    data = field([rotation(AXIS)], latitude, longitude, ("latitude", "longitude"), ("a", "b"))
    data["c"] = data["b"] * 2.0
    for name in data:
        data[name].attrs.update(MS, standard_name="eastward_wind" if name == "a" else "northward_wind")
    with pytest.raises(InputError, match="a may belong to b or c"):
        read_field(written(tmp_path, data))


@pytest.mark.parametrize(
    "change",
    [
        {"units": "knots"},
        {"units": "K"},
    ],
)
def test_components_of_different_units_are_no_pair(tmp_path, change):
    data = field([rotation(AXIS)], *grid(10.0), dims=("latitude", "longitude"))
    data.v10.attrs.update(change)
    with pytest.raises(InputError, match="no eastward and northward"):
        read_field(written(tmp_path, data))
    with pytest.raises(InputError, match="are not one vector"):
        read_field(tmp_path / "a.nc", Choice(vector="u10,v10"))


def test_two_kinds_of_vectors_are_not_chosen_between(tmp_path):
    data = field([rotation(AXIS)], *grid(10.0), dims=("latitude", "longitude"), names=("ua", "va"))
    data["uo"], data["vo"] = data["ua"], data["va"]
    with pytest.raises(InputError, match=r"ua,va.*uo,vo|uo,vo.*ua,va"):
        read_field(written(tmp_path, data))


def test_anomalies_and_stress_come_after_the_current(tmp_path):
    data = field([rotation(AXIS)], *grid(10.0), dims=("latitude", "longitude"), names=("ugosa", "vgosa"))
    data["ugosa"].attrs["long_name"] = "Geostrophic velocity anomalies: zonal component"
    data["vgosa"].attrs["long_name"] = "Geostrophic velocity anomalies: meridian component"
    data["ugos"], data["vgos"] = data["ugosa"].copy(), data["vgosa"].copy()
    data["ugos"].attrs["long_name"], data["vgos"].attrs["long_name"] = "zonal component", "meridian component"
    assert [array.name for array in read_field(written(tmp_path, data)).read.arrays] == ["ugos", "vgos"]


def test_a_file_without_vectors_is_refused_with_its_contents(tmp_path):
    data = field([rotation(AXIS)], *grid(10.0), dims=("latitude", "longitude"), names=("t2m", "msl"))
    with pytest.raises(InputError, match=r"no eastward and northward.*t2m, msl"):
        read_field(written(tmp_path, data))


# Levels, members, times -----------------------------------------------------------------------------------------------


def levelled(dim, values, attrs, times=1):
    latitude, longitude = grid(3.0)
    steps = [
        field([storm(15.0 + 5.0 * i + 2.0 * j, 300.0) for j in range(times)], latitude, longitude)
        for i in range(len(values))
    ]
    joined = xarray.concat(steps, dim)
    return joined.assign_coords({dim: (dim, values, attrs)}).transpose("time", dim, "latitude", "longitude")


DIMENSIONS = [
    ("pressure_level", [1000.0, 850.0, 500.0], {"units": "hPa", "standard_name": "air_pressure"}, "850", "level"),
    ("plev", [100000.0, 85000.0, 50000.0], {"units": "Pa"}, "850", "level"),
    ("plev", [100000.0, 85000.0, 50000.0], {"units": "Pa"}, "85000", "level"),
    ("depth", [0.5, 10.25, 100.0], {"positive": "down", "units": "m"}, "10.25", "level"),
    ("number", [0, 3, 5], {"standard_name": "realization"}, "3", "member"),
    ("ensemble", ["a", "b", "c"], {}, "b", "member"),
    ("expver", [1, 5, 6], {}, "5", "at"),
    ("scenario", ["x", "y", "z"], {}, "y", "at"),
]


@pytest.mark.parametrize("times", [1, 4])
@pytest.mark.parametrize(("dim", "values", "attrs", "wanted", "option"), DIMENSIONS)
def test_levels_and_members_are_chosen_and_never_become_time(tmp_path, dim, values, attrs, wanted, option, times):
    path = written(tmp_path, levelled(dim, values, attrs, times))
    with pytest.raises(InputError, match=rf"3 values of {dim} .*choose one with --{option}"):
        read_field(path)
    choice = Choice(at=((dim, wanted),)) if option == "at" else Choice(**{option: wanted})
    data = read_field(path, choice)
    assert len(data.lambdas) == times
    for j in range(times):
        assert_is(data, storm(20.0 + 2.0 * j, 300.0), 0.15, j)
    assert str(wanted)[:3] in str(data.read.selected[dim])
    refused = Choice(at=((dim, "77"),)) if option == "at" else Choice(**{option: "77"})
    with pytest.raises(InputError, match=rf"{dim} has no 77; choose from"):
        read_field(path, refused)
    assert len(read_mesh(path)[1].choices) == 2


def test_a_level_that_is_not_there_and_two_dimensions_left_over(tmp_path):
    plain = written(tmp_path, field([LOW], *grid(5.0)))
    with pytest.raises(InputError, match="no level to choose"):
        read_field(plain, Choice(level="850"))
    data = levelled("level", [1, 2], {}).expand_dims(number=[0, 1, 2])
    with pytest.raises(InputError, match=r"3 values of number .*--member VALUE and .*2 values of level .*--level"):
        read_field(written(tmp_path, data, "b.nc"))


def test_a_forecast_goes_over_its_lead_time_where_that_is_the_only_one(tmp_path):
    data = field([storm(15.0 + k, 300.0) for k in range(3)], *grid(5.0)).rename(time="step")
    data["step"] = ("step", [0.0, 6.0, 12.0], {"units": "hours", "standard_name": "forecast_period"})
    read = read_field(written(tmp_path, data))
    assert read.read.times == (0.0, 6.0, 12.0)
    assert read.read.time_unit == "hours"
    both = xarray.concat([data, data], "time").assign_coords(
        time=("time", [0, 24], {"units": "hours since 2020-01-01"})
    )
    with pytest.raises(InputError, match="3 values of step"):
        read_field(written(tmp_path, both, "b.nc"))
    assert len(read_field(tmp_path / "b.nc", Choice(at=(("step", "6"),))).lambdas) == 2


def test_lambda_is_linear_in_time_and_times_are_dates(tmp_path):
    """6-hourly with a gap: λ keeps the gap."""
    data = field([storm(15.0 + k, 300.0) for k in range(6)], *grid(5.0))
    data = data.assign_coords(time=("time", [0.0, 6, 12, 36, 42, 48], {"units": "hours since 2018-10-06"}))
    read = read_field(written(tmp_path, data))
    assert np.allclose(read.lambdas, [0, 0.125, 0.25, 0.75, 0.875, 1.0])
    assert read.read.times[3] == "2018-10-07T12:00:00"
    assert read.geography.time(0.5) == "2018-10-07T00:00:00"


@pytest.mark.parametrize(
    ("wanted", "count"),
    [
        (("2018-10-06T06", "2018-10-07T12:00:00"), 3),
        (("2018-10-07", "2018-10-09"), 3),
        (("12", "12"), 1),
        (("2018-10-06T12:00Z", "2018-10-06 12:00"), 1),
    ],
)
def test_times_are_chosen(tmp_path, wanted, count):
    data = field([storm(15.0 + k, 300.0) for k in range(6)], *grid(5.0))
    data = data.assign_coords(time=("time", [0.0, 6, 12, 36, 42, 48], {"units": "hours since 2018-10-06"}))
    path = written(tmp_path, data)
    assert len(read_field(path, Choice(times=wanted)).lambdas) == count
    with pytest.raises(InputError, match="no time from 2019"):
        read_field(path, Choice(times=("2019-01-01", "2019-02-01")))
    with pytest.raises(InputError, match="yesterday is no date"):
        read_field(path, Choice(times=("yesterday", "2019-02-01")))


CALENDARS = [
    ("days since 2000-01-01", "360_day", "2000-01-01T00:00:00"),
    ("days since 2000-01-01", "noleap", "2000-01-01T00:00:00"),
    ("months since 1955-01-01", "standard", 0.0),
    ("months since 1955-01-01", None, 0.0),
    ("days since 0000-00-00", None, 0.0),
    ("years since 1-1-1", "standard", 0.0),
    ("day as %Y%m%d.%f", None, 0.0),
    ("seconds since 1970-01-01T00:00:00Z", "proleptic_gregorian", "1970-01-01T00:00:00"),
    ("", None, 0.0),
]


@pytest.mark.parametrize(("unit", "calendar", "first"), CALENDARS)
def test_calendars_that_nobody_decodes_stay_numbers(tmp_path, unit, calendar, first):
    data = field([storm(15.0 + k, 300.0) for k in range(3)], *grid(5.0))
    attrs = ({"units": unit} if unit else {}) | ({"calendar": calendar} if calendar else {})
    data = data.assign_coords(time=("time", [0.0, 30.0, 90.0], attrs))
    read = read_field(written(tmp_path, data))
    assert np.allclose(read.lambdas, [0, 1 / 3, 1])
    assert read.read.times[0] == first
    if first == 0.0:
        assert read.read.time_unit == unit


def test_times_are_never_invented(tmp_path):
    data = field([storm(15.0 + k, 300.0) for k in range(4)], *grid(5.0)).drop_vars("time")
    read = read_field(written(tmp_path, data))
    assert read.read.times == ()
    assert read.geography.time(0.5) is None
    assert "no times in the file" in said(read)
    assert np.allclose(read.lambdas, [0, 1 / 3, 2 / 3, 1])


def test_times_that_run_backwards_are_sorted_and_equal_ones_refused(tmp_path):
    data = field([storm(15.0 + k, 300.0) for k in range(3)], *grid(5.0))
    read = read_field(written(tmp_path, data.isel(time=[2, 0, 1])))
    assert_is(read, storm(16.0, 300.0), 0.2, 1)
    with pytest.raises(InputError, match="give times that increase"):
        read_field(written(tmp_path, data.isel(time=[0, 1, 1]), "b.nc"))


# Missing values -------------------------------------------------------------------------------------------------------

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


@pytest.mark.parametrize(
    ("value", "attrs"),
    [
        (np.nan, {}),
        (-9999.0, {"missing_value": -9999.0}),
        (-9999.0, {}),
        (-999.0, {}),
        (1e20, {}),
        (9.96921e36, {}),
        (-32767.0, {}),
        (np.inf, {}),
        (50.0, {"valid_range": np.array([-20.0, 20.0])}),
        (-50.0, {"valid_min": -20.0}),
    ],
)
def test_the_surface_ends_where_values_are_missing(tmp_path, value, attrs):
    latitude, longitude = grid(2.0)
    data = with_land(latitude, longitude, value)
    for name in ("uo", "vo"):
        data[name].attrs.update(attrs)
    read = read_field(written(tmp_path, data))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert mesh.boundary_loop_count == 3
    assert mesh.component_count == 1
    assert mesh.euler_characteristic == -1
    assert_is(read, rotation(AXIS))
    count = int(land(latitude, longitude).sum())
    assert f"{count} grid points without value" in said(read)
    assert ("undeclared" in said(read)) == (np.isfinite(value) and not attrs)
    assert len(topology(read).fixed_points) == 2


def test_packed_values_and_their_packed_limits(tmp_path):
    data = with_land(*grid(2.0), np.nan)
    packing = {"dtype": "int16", "scale_factor": 0.001, "add_offset": 1.0, "_FillValue": -32768}
    path = written(tmp_path, data, encoding={"uo": packing, "vo": packing}, format="NETCDF3_CLASSIC")
    read = read_field(path)
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).boundary_loop_count == 3
    assert_is(read, rotation(AXIS))


def test_land_that_changes_in_time_is_left_out_at_all_times(tmp_path):
    latitude, longitude = grid(2.0)
    data = field([rotation(AXIS), rotation(2 * AXIS)], latitude, longitude)
    data.u10.values[1][land(latitude, longitude)] = np.nan
    read = read_field(written(tmp_path, data))
    assert native.TriangleMesh(read.mesh.vertices, read.mesh.triangles).boundary_loop_count == 3
    assert "at some times" in said(read)


def test_a_time_without_values_and_a_field_without_any_are_refused(tmp_path):
    data = field([rotation(AXIS)] * 3, *grid(5.0))
    data.u10.values[1] = np.nan
    with pytest.raises(InputError, match="2018-10-06T06:00:00 is without any value"):
        read_field(written(tmp_path, data))
    data.u10.values[:] = np.nan
    with pytest.raises(InputError, match="nothing is left"):
        read_field(written(tmp_path, data, "b.nc"))


def test_land_filled_with_zeros_is_told(tmp_path):
    read = read_field(written(tmp_path, with_land(*grid(2.0), 0.0)))
    assert "are zero at all times; if that is land" in said(read)


def test_an_ocean_that_leaves_a_pole_out_has_a_boundary_there(tmp_path):
    """Currents from 80° S to the north pole."""
    latitude, longitude = grid(2.0)
    data = with_land(latitude, longitude, np.nan).sel(latitude=slice(90, -80)).expand_dims(depth=[0.5])
    read = read_field(written(tmp_path, data))
    mesh = native.TriangleMesh(read.mesh.vertices, read.mesh.triangles)
    assert (mesh.boundary_loop_count, mesh.component_count) == (4, 1)
    assert_is(read, rotation(AXIS))
    assert "ends at -80° latitude" in said(read)


# Regions and other grids ----------------------------------------------------------------------------------------------


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


def along_the_grid(latitude, longitude, u, v):
    from stormfield.readers.grids.patch import direction_of_rows

    angle = direction_of_rows(latitude, longitude)
    return u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle), angle


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


# Meshes ---------------------------------------------------------------------------------------------------------------


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


# Files ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", ["NETCDF3_64BIT", "NETCDF4", "zarr", "npz"])
def test_formats(tmp_path, version):
    winds = [storm(15.0 + k, 300.0) for k in range(3)]
    data = field(winds, *grid(5.0))
    if version == "zarr":
        pytest.importorskip("zarr")
        data.to_zarr(tmp_path / "a.zarr")
        path = tmp_path / "a.zarr"
    elif version == "npz":
        path = tmp_path / "a.npz"
        arrays = {"u": data.u10.values, "v": data.v10.values, "lat": data.latitude.values, "lon": data.longitude.values}
        arrays = {
            name: np.round(100 * values).astype(np.int16) if name in "uv" else values for name, values in arrays.items()
        }
        times = np.array(["2018-10-06T00", "2018-10-06T06", "2018-10-06T12"], "datetime64[s]")
        np.savez(path, **arrays, scale=np.float32(0.01), time=times)
    else:
        path = written(tmp_path, data, format=version)
    read = read_field(path)
    for k in range(3):
        assert_is(read, winds[k], 0.3, k)
    assert read.read.times == ("2018-10-06T00:00:00", "2018-10-06T06:00:00", "2018-10-06T12:00:00")
    assert np.asarray(read.vectors).shape == read.vectors.shape


@pytest.mark.parametrize("how", ["pattern", "folder"])
def test_many_files_are_one(tmp_path, how):
    """Each counts its hours from its own start; u and v are in files of their own."""
    pytest.importorskip("dask")
    winds = [storm(15.0 + k, 300.0) for k in range(4)]
    data = field(winds, *grid(5.0))
    folder = tmp_path / "files"
    folder.mkdir()
    for first in (0, 2):
        part = data.isel(time=slice(first, first + 2))
        attrs = {"units": f"hours since 2018-10-06T{6 * first:02d}:00:00"}
        part = part.assign_coords(time=("time", part.time.values - 6.0 * first, attrs))
        for name in ("u10", "v10"):
            part[[name]].to_netcdf(folder / f"{name}_{first}.nc")
    read = read_field(folder / "*.nc" if how == "pattern" else folder)
    assert read.read.times[-1] == "2018-10-06T18:00:00"
    assert np.allclose(read.lambdas, [0, 1 / 3, 2 / 3, 1])
    for k in range(4):
        assert_is(read, winds[k], 0.3, k)
    assert len(read.read.files) == 4


def test_files_that_do_not_join_are_refused(tmp_path):
    pytest.importorskip("dask")
    written(tmp_path, field([LOW], *grid(5.0)), "w0.nc")
    written(tmp_path, field([LOW], *grid(10.0)).assign_coords(time=[6.0]), "w1.nc")
    with pytest.raises(InputError, match="its 2 files do not join"):
        read_field(tmp_path / "w*.nc")
    with pytest.raises(InputError, match="no file has such a name"):
        read_field(tmp_path / "none*.nc")


@pytest.mark.parametrize("name", ["gfs.t00z.pgrb2.1p00.f000", "a.grib2"])
def test_grib_without_cfgrib_says_so(tmp_path, name, monkeypatch):
    (tmp_path / name).write_bytes(b"GRIB\x00\x00\x00\x02")
    monkeypatch.setattr("stormfield.readers.grids.opening.importlib.util.find_spec", lambda _name: None)
    with pytest.raises(InputError, match=r"needs the Python package cfgrib.*stormfield\[grib\]"):
        read_field(tmp_path / name)


def test_bad_files_are_refused_in_one_line(tmp_path):
    for name in ("a.nc", "a.npz", "a.h5"):
        (tmp_path / name).write_bytes(b"\x00nonsense\n")
        with pytest.raises(InputError) as fault:
            read_field(tmp_path / name)
        assert name in str(fault.value)
        assert "\n" not in str(fault.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.assign_coords(latitude=2 * d.latitude), "outside -90..90"),
        (lambda d: d.assign_coords(latitude=0 * d.latitude), "given twice"),
        (lambda d: d.drop_vars(["latitude", "longitude"]), "no latitude and longitude"),
        (lambda d: d.isel(latitude=0), "one dimension each|at one place|no latitude and longitude"),
    ],
)
def test_grids_that_are_none_are_refused(tmp_path, change, words):
    data = field([rotation(AXIS)], *grid(10.0), dims=("latitude", "longitude"))
    with pytest.raises(InputError, match=words):
        read_field(written(tmp_path, change(data)))


def test_one_time_is_read_after_another(tmp_path, monkeypatch):
    """Of many times only those that are asked for are made."""
    from stormfield.readers.grids.surface import Surface

    data = read_field(written(tmp_path, field([storm(15.0 + k, 300.0) for k in range(8)], *grid(5.0))))
    made = []
    original = data.vectors.surface.vectors
    counted = Surface(data.mesh, lambda u, v: made.append(0) or original(u, v))
    object.__setattr__(data.vectors, "surface", counted)
    assert data.vectors.shape == (8, len(data.mesh.vertices), 3)
    assert made == []
    data.at(0.5)
    assert len(made) <= 2


def test_pairs_are_found_in_any_order():
    data = two_heights(ORDERS[1], True)
    found = pairs.find_pairs({name: data[name] for name in data.data_vars})
    assert [pair.names for pair in found] == ["u10,v10", "u100,v100"]
    assert cftime  # the calendars of times need it


def test_currents_of_roms_at_the_sides_of_inner_cells(tmp_path):
    latitude, longitude = displaced((240, 270))
    latitude, longitude = latitude[90:111, 60:81], longitude[90:111, 60:81]

    def at(phi, theta):
        return along_the_grid(phi, theta, *components(rotation(AXIS), phi, theta))

    angle = at(latitude, longitude)[2]
    u = at(*(0.5 * (a[:, 1:] + a[:, :-1]) for a in (latitude, longitude)))[0]
    v = at(*(0.5 * (a[1:] + a[:-1]) for a in (latitude, longitude)))[1]
    rho = ("eta_rho", "xi_rho")
    data = xarray.Dataset(
        {
            "u": (("ocean_time", "eta_u", "xi_u"), u[None], {"units": "meter second-1"}),
            "v": (("ocean_time", "eta_v", "xi_v"), v[None], {"units": "meter second-1"}),
            "angle": (rho, angle, {"units": "radians"}),
        },
        {
            "lat_rho": (rho, latitude, {"units": "degree_north"}),
            "lon_rho": (rho, longitude, {"units": "degree_east"}),
            "ocean_time": ("ocean_time", [0.0], {"units": "seconds since 2000-01-01"}),
        },
    )
    read = read_field(written(tmp_path, data))
    assert len(read.mesh.vertices) == 19 * 19
    assert_is(read, rotation(AXIS), 2e-3)
    assert "averaged to the middle" in said(read)


def grib(path, messages):
    """Messages (short name, type of level, level, step in hours, values (a, b)) on a grid from the north pole."""
    eccodes = pytest.importorskip("eccodes")
    with path.open("wb") as file:
        for name, kind, level, step, values in messages:
            message = eccodes.codes_grib_new_from_samples("regular_ll_sfc_grib2")
            rows, columns = values.shape
            keys = {"Ni": columns, "Nj": rows, "latitudeOfFirstGridPointInDegrees": 90.0}
            keys |= {"latitudeOfLastGridPointInDegrees": -90.0, "longitudeOfFirstGridPointInDegrees": 0.0}
            keys |= {"longitudeOfLastGridPointInDegrees": 360.0 - 360.0 / columns}
            keys |= {
                "iDirectionIncrementInDegrees": 360.0 / columns,
                "jDirectionIncrementInDegrees": 180.0 / (rows - 1),
            }
            keys |= {"dataDate": 20181006, "dataTime": 0, "typeOfLevel": kind, "level": level}
            keys |= {"shortName": name, "step": step, "bitsPerValue": 24}
            for key, value in keys.items():
                eccodes.codes_set(message, key, value)
            eccodes.codes_set_values(message, values.ravel())
            eccodes.codes_write(message, file)
            eccodes.codes_release(message)
    return path


def test_grib_with_kinds_of_levels(tmp_path):
    pytest.importorskip("cfgrib")
    latitude, longitude = grid(5.0)
    messages = []
    for step in (0, 6, 12):
        for wind, kind, level, names in (
            (storm(15.0 + step, 300.0), "heightAboveGround", 10, ("10u", "10v")),
            (storm(30.0 + step, 60.0), "heightAboveGround", 100, ("100u", "100v")),
            (storm(-30.0 - step, 60.0), "isobaricInhPa", 850, ("u", "v")),
            (storm(-20.0 - step, 160.0), "isobaricInhPa", 500, ("u", "v")),
        ):
            for name, values in zip(names, components(wind, latitude[:, None], longitude[None]), strict=True):
                messages.append((name, kind, level, step, values))
    path = grib(tmp_path / "gfs.f000", messages)
    read = read_field(path)
    assert [array.name for array in read.read.arrays] == ["u10", "v10"]
    assert read.read.times == ("2018-10-06T00:00:00", "2018-10-06T06:00:00", "2018-10-06T12:00:00")
    for j, step in enumerate((0, 6, 12)):
        assert_is(read, storm(15.0 + step, 300.0), 0.3, j)
    with pytest.raises(InputError, match=r"2 values of isobaricInhPa .*--level"):
        read_field(path, Choice(vector="u,v"))
    read = read_field(path, Choice(vector="u,v", level="850"))
    assert_is(read, storm(-42.0, 60.0), 0.3, 2)


def test_grib_that_is_cut_off_is_refused(tmp_path, caplog):
    """cfgrib would leave the broken message out and go on with the others."""
    pytest.importorskip("cfgrib")
    latitude, longitude = grid(10.0)
    u, v = components(rotation(AXIS), latitude[:, None], longitude[None])
    path = grib(tmp_path / "a.grib2", [("10u", "heightAboveGround", 10, step, u) for step in (0, 6)])
    grib(path2 := tmp_path / "b.grib2", [("10v", "heightAboveGround", 10, step, v) for step in (0, 6)])
    path.write_bytes(path.read_bytes() + path2.read_bytes())
    assert len(read_field(path).vectors) == 2
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match=r"a\.grib2: is not GRIB that cfgrib reads") as fault:
        read_field(path)
    assert "\n" not in str(fault.value) and not caplog.records


def test_era5_as_the_climate_data_store_writes_it(tmp_path):
    """valid_time, number of one member, expver as words along the times, packed, standard names unknown."""
    winds = [storm(15.0 + 5.0 * k, 315.0 - 7.5 * k) for k in range(5)]
    data = field(winds, *grid(2.0)).rename(time="valid_time")
    for name in ("u10", "v10"):
        data[name].attrs = {"units": "m s**-1", "standard_name": "unknown", "GRIB_paramId": 165, "long_name": f"{name}"}
    data["valid_time"] = (
        "valid_time",
        21600 * np.arange(5),
        {"units": "seconds since 1970-01-01", "standard_name": "time"},
    )
    data = data.assign_coords(number=0, expver=("valid_time", ["0001", "0001", "0001", "0005", "0005"]))
    packing = {"dtype": "int16", "scale_factor": 0.002, "add_offset": 0.0, "_FillValue": -32768}
    read = read_field(written(tmp_path, data, encoding={"u10": packing, "v10": packing}))
    assert read.read.times[-1] == "1970-01-02T00:00:00"
    for j, wind in enumerate(winds):
        assert_is(read, wind, 0.1, j)


def test_the_valid_time_of_a_chosen_lead_is_the_time(tmp_path):
    data = xarray.concat([field([storm(15.0 + k, 300.0) for k in range(2)], *grid(5.0))] * 2, "step")
    data = data.assign_coords(step=("step", [0.0, 6.0], {"units": "hours", "standard_name": "forecast_period"}))
    data["time"] = (
        "time",
        [0.0, 24.0],
        {"units": "hours since 2020-01-01", "standard_name": "forecast_reference_time"},
    )
    valid = data.time.values[:, None] + data.step.values[None]
    data = data.assign_coords(
        valid_time=(("time", "step"), valid, {"units": "hours since 2020-01-01", "standard_name": "time"})
    )
    read = read_field(written(tmp_path, data), Choice(at=(("step", "6"),)))
    assert read.read.times == ("2020-01-01T06:00:00", "2020-01-02T06:00:00")


@pytest.mark.parametrize(("value", "words"), [(1e200, "cannot be computed"), (0.0, "zero everywhere")])
def test_numbers_that_cannot_be_computed_with_are_refused(tmp_path, value, words):
    latitude, longitude = grid(10.0)
    attrs = {"units": "N m-2"}
    data = field([rotation(AXIS * value)], latitude, longitude, ("latitude", "longitude"), ("taux", "tauy"), attrs)
    with pytest.raises(InputError, match=words):
        read_field(written(tmp_path, data))


def test_a_rotated_pole_with_true_places(tmp_path):
    """As CORDEX: rows and columns of another pole, latitude and longitude of each point, eastward winds."""
    latitude, longitude = displaced()
    latitude, longitude = latitude[20:40, 20:50], longitude[20:40, 20:50]
    data = curvilinear(latitude, longitude, rotation(AXIS)).rename(y="rlat", x="rlon")
    for name, meaning in (("u", "eastward_wind"), ("v", "northward_wind")):
        data[name].attrs["standard_name"] = meaning
    data = data.assign_coords(
        rlat=("rlat", np.arange(20.0), {"units": "degrees", "standard_name": "grid_latitude"}),
        rlon=("rlon", np.arange(30.0), {"units": "degrees", "standard_name": "grid_longitude"}),
    )
    read = read_field(written(tmp_path, data))
    assert_is(read, rotation(AXIS), 1e-9)
    assert "taken as" not in said(read)


def test_winds_of_the_wrf_near_the_surface_come_before_those_of_levels(tmp_path):
    data = xarray.merge([wrf(staggered=True), wrf()], compat="override")
    assert [array.name for array in read_field(written(tmp_path, data)).read.arrays] == ["U10", "V10"]


def test_import_makes_a_cache_in_the_size_of_a_scene(tmp_path, capsys):
    import json

    from stormfield.cache.field_cache import open_cache
    from stormfield.cli import main

    path = written(tmp_path, field([rotation(AXIS), rotation(2 * AXIS)], *grid(10.0)))
    arguments = ["import", str(path), "--out", str(tmp_path / "cache"), "--seconds", "6", "--json", "-"]
    assert main(arguments) == 0
    report = json.loads(capsys.readouterr().out)
    cache = open_cache(tmp_path / "cache")
    assert np.allclose(np.linalg.norm(cache.mesh.vertices, axis=1), 1.0, atol=1e-6)
    factor = 6 * 3600 / 6 / RADIUS
    assert report["scale"]["speeds"] == pytest.approx(factor)
    exact = 2 * factor * np.cross(AXIS, cache.mesh.vertices)
    found = cache.at(1.0)["sf_advection"]
    assert np.abs(found - exact).max() < 0.02 * np.abs(exact).max()
    assert main(["import", str(path), "--out", str(tmp_path / "b"), "--seconds", "0"]) == 2
    assert main(["import", str(path), "--out", str(path)]) == 2


def test_values_are_decoded_as_xarray_decodes_them(tmp_path):
    """Packed, unsigned, with two marks of no value, with strings and characters."""
    data = field([storm(25.0, 285.0)] * 2, *grid(10.0))
    data["name"] = ("time", np.array(["first", "second"], object))
    data["odd"] = (("latitude", "longitude"), np.arange(19 * 36, dtype=np.int16).reshape(19, 36))
    data.odd.attrs = {"missing_value": np.int16(7), "scale_factor": 0.5, "add_offset": 3.0}
    data["bytes"] = (
        ("latitude", "longitude"),
        (np.arange(19 * 36) % 256).astype(np.uint8).view(np.int8).reshape(19, 36),
    )
    data.bytes.attrs = {"_Unsigned": "true", "scale_factor": 2.0}
    path = written(tmp_path, data, encoding={"u10": {"dtype": "int16", "scale_factor": 0.01, "_FillValue": -9999}})
    with netcdf.netcdf(path) as ours, xarray.open_dataset(path, decode_times=False) as theirs:
        assert set(ours.variables) == set(map(str, theirs.variables))
        assert set(ours.data_vars) == set(map(str, theirs.data_vars))
        for name in ours.variables:
            mine, other = ours[name], theirs[name]
            assert (mine.dims, mine.shape) == (other.dims, other.shape), name
            if other.dtype.kind in "iuf":
                assert np.allclose(mine.values, other.values, rtol=1e-6, equal_nan=True), name
                chosen = {mine.dims[0]: -1}
                assert np.allclose(mine.isel(chosen).values, other.isel(chosen).values, rtol=1e-6, equal_nan=True), name
            else:
                assert mine.values.tolist() == other.values.tolist()
        assert np.array_equal(
            ours["u10"].isel({"time": 1}).transpose("longitude", "latitude").values.T, ours["u10"].values[1]
        )


def test_single_files_need_no_xarray(tmp_path, monkeypatch):
    """Blender has no xarray; what the extension brings is enough for NetCDF."""
    import builtins

    path = written(tmp_path, field([LOW] * 2, *grid(5.0)))
    original = builtins.__import__

    def without(name, *arguments, **options):
        if name.split(".")[0] in ("xarray", "pandas", "dask", "scipy"):
            raise ImportError(name)
        return original(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    assert len(read_field(path).lambdas) == 2
