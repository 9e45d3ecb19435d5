# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats of grids, many files at once, and what is refused in words."""

import cftime
import numpy as np
import pytest
import xarray
from analytic_wind import components, grid, rotation, storm
from grid_cases import (
    AXIS,
    LOW,
    ORDERS,
    RADIUS,
    along_the_grid,
    assert_is,
    curvilinear,
    displaced,
    field,
    said,
    two_heights,
    wrf,
    written,
)
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field
from stormfield.readers.grids import components as pairs
from stormfield.readers.grids import netcdf

pytestmark = pytest.mark.usefixtures("reader")


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
