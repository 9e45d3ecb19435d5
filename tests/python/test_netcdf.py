# SPDX-License-Identifier: GPL-3.0-or-later
"""NetCDF read with netCDF4 and without it, as in Blender: the same variables, values and attributes."""

import netCDF4
import numpy as np
import pytest
from stormfield.model.errors import InputError, MissingPackageError
from stormfield.readers import read_field
from stormfield.readers.grids import netcdf

pytest.importorskip("pyfive")
CLASSIC = ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA")
FORMATS = (*CLASSIC, "NETCDF4", "NETCDF4_CLASSIC")


@pytest.fixture
def file(tmp_path):
    def opened(format="NETCDF4", **sizes):
        dataset = netCDF4.Dataset(tmp_path / "a.nc", "w", format=format)
        dataset.set_auto_maskandscale(False)
        for name, size in sizes.items():
            dataset.createDimension(name, size)
        return dataset

    return opened


def add(file, name, kind, dims, values=None, **options):
    attrs = options.pop("attrs", {})
    variable = file.createVariable(name, kind, dims, **options)
    variable.setncatts(attrs)
    variable.set_auto_maskandscale(False)
    if values is not None:
        variable[...] = values
    return variable


def without(monkeypatch, *modules):
    monkeypatch.setattr(netcdf, "_has", lambda module: module not in modules)


def stored(path):
    """Everything that a file says, by variable, and its groups."""
    with netcdf._opened(path) as file:
        found = {}
        for one in file.variables:
            whole = (slice(None),) * len(one.shape)
            read = [one.read(whole)]
            if one.shape and all(one.shape):
                read += [one.read((k, *whole[1:])) for k in (0, one.shape[0] // 2, -1)]
                read += [one.read((*whole[:-1], -1)), one.read((0,) * len(one.shape))]
            found[one.name] = (one.dims, one.shape, one.dtype, dict(one.attrs), read)
        return found, file.groups


def assert_same(ours, theirs):
    if isinstance(theirs, dict):
        assert ours.keys() == theirs.keys()
        for key in theirs:
            assert_same(ours[key], theirs[key])
    elif isinstance(theirs, list | tuple):
        assert len(ours) == len(theirs)
        for mine, other in zip(ours, theirs, strict=True):
            assert_same(mine, other)
    elif isinstance(theirs, np.ndarray | np.generic):
        assert (ours.dtype, ours.shape) == (theirs.dtype, theirs.shape)
        assert ours.tobytes() == theirs.tobytes() if theirs.dtype.kind in "iuf" else ours.tolist() == theirs.tolist()
    else:
        assert type(ours) is type(theirs) and ours == theirs


def assert_read_alike(path, monkeypatch):
    with monkeypatch.context() as patch:
        without(patch)
        theirs = stored(path)
        without(patch, "netCDF4")
        assert_same(stored(path), theirs)


@pytest.mark.parametrize("format", FORMATS)
def test_all_formats_are_read_alike(file, tmp_path, monkeypatch, format):
    """Packed, unlimited, characters, one number, and attributes of every kind."""
    with file(format, time=None, y=5, x=7, n=4) as new:
        new.title, new.empty = "Größe", ""
        units = {"units": "hours since 2000-01-01", "calendar": "noleap"}
        add(new, "time", "f8", ("time",), [0.0, 6.0, 12.0], attrs=units)
        packing = {"scale_factor": 0.01, "add_offset": np.float32(2.0), "valid_range": np.array([-500, 500], "i2")}
        values = np.arange(105).reshape(3, 5, 7)
        add(new, "u", "i2", ("time", "y", "x"), values, fill_value=-999, attrs=packing)
        add(new, "w", "f4", ("time", "y", "x"))[0] = 1.5
        add(new, "plain", "f8", ("y", "x"), values[0], attrs={"one": "k", "none": "", "list": [1.0, 2.0]})
        add(new, "bytes", "i1", ("time", "x"), values[:, 0])
        add(new, "crs", "i4", (), 3, attrs={"number": np.int32(5)})
        add(new, "names", "S1", ("time", "n"), np.array([list("abcd")] * 3, "S1"))
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


def test_what_only_netcdf4_has_is_read_alike(file, tmp_path, monkeypatch):
    """Words, whole and in part; unsigned and long numbers; big-endian; empty; enumerations; a group."""
    with file(time=None, x=6, none=0) as new:
        add(new, "time", "f8", ("time",), [0.0, 6.0, 12.0])
        add(new, "label", str, ("time",))[:2] = np.array(["first", "zweiter Größe"], object)
        add(new, "word", str, (), np.array("one", object))
        add(new, "u1", "u1", ("x",), np.arange(6), attrs={"words": ["a", "b"]})
        add(new, "i8", "i8", ("x",), np.arange(6))
        add(new, "big", ">f4", ("x",), np.arange(6), endian="big", attrs={"more": np.array([1, 2], ">i2")})
        add(new, "empty", "f4", ("none",))
        add(new, "never", "f4", ("x",))
        add(new, "kinds", new.createEnumType("i1", "kind", {"land": 0, "sea": 1}), ("x",), [0, 1] * 3)
        new.createGroup("more")
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"zlib": True},
        {"zlib": True, "shuffle": True, "fletcher32": True},
        {"zlib": True, "chunksizes": (1, 2, 3)},
        {"zlib": True, "least_significant_digit": 2},
    ],
)
def test_compressed_values_are_read_alike(file, tmp_path, monkeypatch, options):
    with file(time=None, y=5, x=7) as new:
        add(new, "u", "f4", ("time", "y", "x"), np.sin(np.arange(105)).reshape(3, 5, 7), **options)
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


def test_what_was_never_written_is_fill(file, tmp_path, monkeypatch):
    """Whole times, and chunks of a time."""
    with file(time=None, y=9, x=16) as new:
        add(new, "time", "f8", ("time",), np.arange(5.0))
        u = add(new, "u", "i2", ("time", "y", "x"), fill_value=-5, zlib=True, chunksizes=(1, 4, 5))
        u[3] = np.arange(144).reshape(9, 16)
        u[1, 2:3, 11:12] = 77
        add(new, "v", "f4", ("time", "y", "x"), zlib=True, chunksizes=(2, 9, 16))[2:4] = 1.0
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


def test_many_variables_and_attributes_are_read_alike(file, tmp_path, monkeypatch):
    """HDF5 stores them in other ways when they are many."""
    with file(x=5) as new:
        for k in range(200):
            add(new, f"v{k}", "f4", ("x",), k, attrs={f"a{j}": j for j in range(60)} if k == 7 else {})
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


@pytest.mark.parametrize("format", CLASSIC)
@pytest.mark.parametrize("records", [0, 4])
@pytest.mark.parametrize("variables", [1, 2])
def test_records_of_classic_files(file, tmp_path, monkeypatch, format, records, variables):
    """A record of one variable alone is not padded to four bytes, those of more are."""
    with file(format, time=None, n=3) as new:
        for k in range(variables):
            variable = add(new, f"v{k}", "i1", ("time", "n"))
            if records:
                variable[:records] = np.arange(3 * records).reshape(-1, 3)
        add(new, "fixed", "i2", ("n",), [1, 2, 3])
    assert_read_alike(tmp_path / "a.nc", monkeypatch)


def test_the_number_of_records_of_a_file_that_was_streamed(file, tmp_path, monkeypatch):
    with file("NETCDF3_CLASSIC", time=None, n=4) as new:
        add(new, "v", "f4", ("time", "n"))[:3] = np.arange(12).reshape(3, 4)
    path = tmp_path / "a.nc"
    path.write_bytes(path.read_bytes()[:4] + b"\xff\xff\xff\xff" + path.read_bytes()[8:])
    without(monkeypatch, "netCDF4")
    with netcdf.netcdf(path) as read:
        assert np.array_equal(read["v"].values, np.arange(12.0).reshape(3, 4))


@pytest.mark.parametrize("format", CLASSIC)
def test_a_classic_file_that_is_cut_off_is_refused(file, tmp_path, monkeypatch, format):
    with file(format, time=None, n=40) as new:
        add(new, "v", "f4", ("time", "n"))[:3] = 1.0
    path = tmp_path / "a.nc"
    whole = path.read_bytes()
    without(monkeypatch, "netCDF4")
    path.write_bytes(whole[:-40])
    with (
        netcdf.netcdf(path) as read,
        pytest.raises(InputError, match=r"v cannot be read \(the file is cut off"),
    ):
        read["v"].values  # noqa: B018
    for size in (5, 8, 30, 60):
        path.write_bytes(whole[:size])
        with pytest.raises(InputError, match="header is damaged or cut off"):
            read_field(path)


@pytest.mark.parametrize(("compression", "name"), [("zstd", "Zstandard"), ("bzip2", "bzip2"), ("blosc_lz", "Blosc")])
def test_other_compressions_are_named_with_the_cure(file, tmp_path, monkeypatch, compression, name):
    with file(y=40, x=70) as new:
        add(new, "u", "f4", ("y", "x"), 1.0, compression=compression)
    without(monkeypatch, "netCDF4")
    with (
        netcdf.netcdf(tmp_path / "a.nc") as read,
        pytest.raises(InputError, match=rf"values of u are compressed by {name}.*nccopy -F none.*stormfield import"),
    ):
        read["u"].values  # noqa: B018


def test_types_that_only_netcdf4_reads_are_refused_with_the_cure(file, tmp_path, monkeypatch):
    with file(x=3) as new:
        add(new, "ragged", new.createVLType("f4", "rows"), ("x",))
    without(monkeypatch, "netCDF4")
    with pytest.raises(InputError, match=r"has what only the Python package netCDF4 reads.*stormfield import"):
        read_field(tmp_path / "a.nc")


def test_values_that_are_damaged_are_refused(file, tmp_path, monkeypatch):
    with file(x=4000) as new:
        add(new, "u", "f4", ("x",), np.sin(np.arange(4000)), zlib=True, fletcher32=True)
    path = tmp_path / "a.nc"
    whole = bytearray(path.read_bytes())
    whole[-2000:-1900] = bytes(100)
    path.write_bytes(whole)
    for missing in ((), ("netCDF4",)):
        without(monkeypatch, *missing)
        with netcdf.netcdf(path) as read, pytest.raises(InputError, match="values of u cannot be read"):
            read["u"].values  # noqa: B018


@pytest.mark.parametrize("missing", [(), ("netCDF4",)])
def test_groups_are_said(file, tmp_path, monkeypatch, missing):
    without(monkeypatch, *missing)
    latitude, longitude = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)
    with file(lat=len(latitude), lon=len(longitude)) as new:
        add(new, "lat", "f8", ("lat",), latitude, attrs={"units": "degrees_north"})
        add(new, "lon", "f8", ("lon",), longitude, attrs={"units": "degrees_east"})
        for name in ("u10", "v10"):
            add(new.createGroup("forecast"), name, "f4", ("lat", "lon"), 1.0, attrs={"units": "m s-1"})
    path = tmp_path / "a.nc"
    with pytest.raises(InputError, match=r"variables are in groups \(forecast\).*ncks -G : -g forecast"):
        read_field(path)
    with netCDF4.Dataset(path, "a") as more:
        for name in ("u10", "v10"):
            add(more, name, "f4", ("lat", "lon"), 1.0, attrs={"units": "m s-1"})
    assert "groups of the file are not read: forecast" in read_field(path).read.notes


def test_a_package_that_is_missing_is_named(file, tmp_path, monkeypatch):
    with file(x=3) as new:
        add(new, "u", "f4", ("x",), 1.0)
    without(monkeypatch, "netCDF4", "pyfive")
    with pytest.raises(MissingPackageError, match=r"needs the Python package netCDF4; .*pip install netCDF4"):
        read_field(tmp_path / "a.nc")
    with file("NETCDF3_CLASSIC", x=3) as new:
        add(new, "u", "f4", ("x",), 1.0)
    with netcdf.netcdf(tmp_path / "a.nc") as read:  # needs none
        assert read["u"].values.tolist() == [1.0, 1.0, 1.0]
