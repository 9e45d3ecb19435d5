# SPDX-License-Identifier: GPL-3.0-or-later
"""Wind on a grid of the whole globe: places, lengths, units, resolution, poles."""

import numpy as np
import pytest
from analytic_wind import grid, rotation, storm
from grid_cases import AXIS, RADIUS, assert_is, field, said, topology, written
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field
from stormfield.readers.grids.vocabulary import speed_of

pytestmark = pytest.mark.usefixtures("reader")


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


@pytest.mark.parametrize("missing", [0, -1])
def test_of_two_columns_at_one_longitude_the_one_with_values_is_taken(tmp_path, missing):
    latitude, longitude = grid()
    wind = field([rotation(AXIS)], latitude, np.append(longitude, 360.0))
    wind.u10[..., missing] = np.nan
    assert_is(read_field(written(tmp_path, wind)), rotation(AXIS))


@pytest.mark.parametrize(
    ("unit", "speed"),
    [("0.1 m/s", 0.1), ("1e-2 m s-1", 0.01), ("(m s-1)", 1.0), ("10 * cm s-1", 0.1), ("2", None), ("3 K", None)],
)
def test_units_with_a_factor(unit, speed):
    assert speed_of(unit) == (None if speed is None else pytest.approx(speed))
