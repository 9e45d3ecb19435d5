# SPDX-License-Identifier: GPL-3.0-or-later
"""Which two variables of a grid are one vector, as the models write them."""

import numpy as np
import pytest
import xarray
from analytic_wind import components, grid, rotation
from grid_cases import AXIS, HIGH, LOW, MS, ORDERS, assert_is, field, said, two_heights, written
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field
from stormfield.readers.grids.vocabulary import speed_of

pytestmark = pytest.mark.usefixtures("reader")


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


def test_a_speed_and_a_direction_are_no_components_and_the_cure_is_said(tmp_path):
    latitude, longitude = grid(10.0)
    wind = field([rotation(AXIS)], latitude, longitude, names=("speed", "from"))
    wind.speed.attrs["standard_name"], wind["from"].attrs["standard_name"] = "wind_speed", "wind_from_direction"
    wind["from"].attrs["units"] = "degree"
    with pytest.raises(InputError, match=r"speed and from, a speed and a direction.*u = -speed sin\(direction\)"):
        read_field(written(tmp_path, wind))
