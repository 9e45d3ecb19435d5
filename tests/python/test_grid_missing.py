# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that are none, declared and undeclared: where they are missing the surface ends."""

import numpy as np
import pytest
from analytic_wind import grid, rotation
from grid_cases import AXIS, assert_is, field, land, said, topology, with_land, written
from stormfield import native
from stormfield.model.errors import InputError
from stormfield.readers import read_field

pytestmark = pytest.mark.usefixtures("reader")


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
