# SPDX-License-Identifier: GPL-3.0-or-later
"""Coasts, where values are missing, and the border, where the data end, are told apart."""

import numpy as np
import pytest
from analytic_wind import grid, rotation
from grid_cases import AXIS, field, written
from stormfield.readers import read_field
from stormfield.readers.coasts import boundary_lines

REGION = np.arange(5.0, 46.0, 2.0), np.arange(260.0, 311.0, 2.0)


def lines_of(tmp_path, latitude, longitude, no_value=lambda wind: None):
    wind = field([rotation(AXIS)], latitude, longitude)
    no_value(wind)
    data = read_field(written(tmp_path, wind))
    lines = boundary_lines(data.mesh, None if data.whole is None else data.whole())
    return data, lines.coasts, lines.border


def box(wind, south, north, west, east, mark=np.nan):
    """No value in a part of the grid."""
    inside = (wind.latitude >= south) & (wind.latitude <= north) & (wind.longitude >= west) & (wind.longitude <= east)
    for name in ("u10", "v10"):
        wind[name] = wind[name].where(~inside, mark)


def degrees(data, line):
    place = data.mesh.vertices[line.vertices] / np.linalg.norm(data.mesh.vertices[0])
    return np.degrees(np.arcsin(place[:, 2])), np.mod(np.degrees(np.arctan2(place[:, 1], place[:, 0])), 360.0)


def test_a_globe_without_gaps_has_neither(tmp_path):
    assert lines_of(tmp_path, *grid())[1:] == ([], [])


@pytest.mark.parametrize("mark", [np.nan, -9999.0, 1e20])
def test_land_of_a_globe_is_a_closed_coast_declared_or_not(tmp_path, mark):
    data, coasts, border = lines_of(tmp_path, *grid(), lambda wind: box(wind, -20, 20, 80, 120, mark))
    assert len(coasts) == 1 and coasts[0].closed and not border
    latitude, longitude = degrees(data, coasts[0])
    assert 20 <= np.abs(latitude).max() < 25 and longitude.min() > 75 and longitude.max() < 125


def test_an_ocean_that_ends_before_the_pole_has_a_border_there_and_its_land_a_coast(tmp_path):
    latitude, longitude = np.arange(-60.0, 91.0, 2.0), grid()[1]
    data, coasts, border = lines_of(tmp_path, latitude, longitude, lambda wind: box(wind, 0, 20, 80, 120))
    assert len(coasts) == 1 and len(border) == 1 and border[0].closed
    assert degrees(data, border[0])[0].max() < -55 and degrees(data, coasts[0])[0].min() > -5


def test_a_region_alone_has_a_border_only(tmp_path):
    _, coasts, border = lines_of(tmp_path, *REGION)
    assert not coasts and len(border) == 1 and border[0].closed


def test_an_island_in_a_region_is_a_coast(tmp_path):
    data, coasts, border = lines_of(tmp_path, *REGION, lambda wind: box(wind, 20, 30, 280, 290))
    assert [line.closed for line in (*coasts, *border)] == [True, True]
    assert np.abs(degrees(data, coasts[0])[1] - 285.0).max() < 8 and len(border[0].vertices) == 2 * (20 + 25)


def test_land_at_the_border_of_a_region_is_a_coast_from_border_to_border(tmp_path):
    data, coasts, border = lines_of(tmp_path, *REGION, lambda wind: box(wind, 20, 30, 255, 275))
    assert len(coasts) == 1 and len(border) == 1 and not coasts[0].closed and not border[0].closed
    latitude, longitude = degrees(data, coasts[0])
    assert np.allclose(longitude[[0, -1]], 260.0) and longitude.max() > 275
    assert set(np.round(np.sort(latitude[[0, -1]]))) == {19.0, 31.0}
    assert {coasts[0].vertices[0], coasts[0].vertices[-1]} == {border[0].vertices[0], border[0].vertices[-1]}
