# SPDX-License-Identifier: GPL-3.0-or-later
"""Levels, members and times of grids: which are chosen, and which become λ."""

import numpy as np
import pytest
import xarray
from analytic_wind import grid, storm
from grid_cases import LOW, assert_is, field, said, written
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field, read_mesh

pytestmark = pytest.mark.usefixtures("reader")


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
