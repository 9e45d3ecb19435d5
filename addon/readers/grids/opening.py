# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of grids → one xarray dataset whose arrays are read when asked for: NetCDF, GRIB, zarr, .npz; one or many.

Times stay numbers here: xarray refuses files whose calendar it does not know, and nothing but a label depends on it.
"""

from __future__ import annotations

import glob
import importlib.util
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import InputError, MissingPackageError
from ..geography import COMMON, EPOCH
from .dataset import Dataset, Variable
from .netcdf import netcdf
from .times import times_of
from .vocabulary import is_time

NETCDF = {".nc", ".nc3", ".nc4", ".cdf", ".netcdf", ".h5", ".hdf5", ".he5"}
GRIB = {".grib", ".grb", ".grib2", ".grb2", ".gb2"}
ENDINGS = {".npz", ".zarr", *NETCDF, *GRIB}
#: Files that keep a folder from being one of grids: their numbers may lie in HDF5 files beside them.
SURFACES = {".vtp", ".vtu", ".vtk", ".pvd", ".vtm", ".xdmf", ".xmf", ".ply", ".obj", ".stl", ".off", ".t"}
#: Time after time is read, so that chunks of one time are right.
CHUNKS = {"time": 1, "valid_time": 1, "Time": 1, "time_counter": 1, "ocean_time": 1, "step": 1, "MT": 1}


def is_grid(path: Path) -> bool:
    """By its ending, or by its first bytes where the ending says nothing."""
    if is_pattern(path):
        files = _matching(path)
        return bool(files) and is_grid(files[0])
    if path.is_dir():
        return _is_zarr(path) or bool(_grids_in(path))
    if path.suffix.lower() in ENDINGS:
        return True
    return _begins(path, b"GRIB") or _begins(path, b"CDF")


def is_pattern(path: Path) -> bool:
    """Whether a name stands for many files, such as "era5_*.nc"."""
    return glob.has_magic(str(path)) and not path.exists()


def files_of(path: Path) -> list[Path]:
    """The files of a name, a pattern or a folder, in order. Raises InputError."""
    if is_pattern(path):
        files = _matching(path)
        if not files:
            raise InputError(f"{path}: no file has such a name; check the pattern")
        return files
    if path.is_dir() and not _is_zarr(path):
        return _grids_in(path)
    return [path]


@contextmanager
def open_grid(path: Path) -> Iterator:
    """The dataset of a file, folder or pattern. Raises InputError with what is wrong with which file."""
    files = files_of(path)
    with ExitStack() as stack:
        datasets = [stack.enter_context(_open_one(file, many=len(files) > 1)) for file in files]
        yield datasets[0] if len(datasets) == 1 else _joined(path, files, datasets)


def _open_one(file: Path, many: bool):
    if file.suffix.lower() == ".npz":
        return _npz(file)
    if _is_zarr(file):
        return _opened(file, "zarr", "zarr", "grids", many)
    if file.suffix.lower() in GRIB or _begins(file, b"GRIB"):
        return _grib(file, many)
    return _opened(file, None, "netCDF4", "", many) if many else _netcdf(file)


def _opened(file: Path, engine: str | None, module: str, extra: str, many: bool):
    import xarray

    _need(file, module, extra)
    chunks = _chunks(file) if many else None
    try:
        return xarray.open_dataset(file, engine=engine, decode_times=False, chunks=chunks)
    except Exception as error:
        raise InputError(f"{file}: is not a grid that can be read ({_reason(error)})") from error


def _grib(file: Path, many: bool):
    _need(file, "cfgrib", "grib")
    import cfgrib

    try:
        parts = cfgrib.open_datasets(str(file), backend_kwargs={"indexpath": "", "errors": "raise"}, decode_times=False)
    except Exception as error:
        raise InputError(f"{file}: is not GRIB that cfgrib reads ({_reason(error)})") from error
    return _merged(parts, file) if len(parts) != 1 else parts[0]


def _merged(parts: Sequence, file: Path):
    """One dataset of the parts that cfgrib makes for each kind of level; a name that comes twice gets its level, and so
    does a dimension whose values differ. The level of each variable moves to its attributes: the parts share one name
    for it."""
    import xarray

    if not parts:
        raise InputError(f"{file}: has no messages; check the file")
    arrays: dict[str, Any] = {}
    for part in parts:
        for key, array in part.data_vars.items():
            name, kind = str(key), str(array.attrs.get("GRIB_typeOfLevel", "level"))
            value = array.coords[kind] if kind in array.coords and array.coords[kind].ndim == 0 else None
            if value is not None:
                array = array.drop_vars(kind).assign_attrs(level=float(value))
            if name in arrays:
                name += f"_{kind}" if value is None else f"_{kind}{float(value):g}"
            other = {
                dim: f"{dim}_{kind}"
                for dim in array.dims
                if any(_differs(known, array, dim) for known in arrays.values())
            }
            arrays[name] = array.rename(other).rename(name)
    return xarray.merge(list(arrays.values()), compat="override", join="outer")


def _differs(known, array, dim: object) -> bool:
    return (
        dim in known.coords
        and dim in array.coords
        and not np.array_equal(known.coords[dim].values, array.coords[dim].values)
    )


@contextmanager
def _netcdf(file: Path) -> Iterator[Dataset]:
    with ExitStack() as stack:
        try:
            dataset = stack.enter_context(netcdf(file))
        except InputError:
            raise
        except Exception as error:
            raise InputError(f"{file}: is not a grid that can be read ({_reason(error)})") from error
        yield dataset


@contextmanager
def _npz(file: Path) -> Iterator[Dataset]:
    """u and v on axes that fit by their length, longitude last."""
    try:
        with np.load(file, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: is not an .npz file ({_reason(error)})") from error
    scale = arrays.pop("scale", None)
    axes = {name: values for name, values in arrays.items() if values.ndim == 1}
    found = {}
    for name, values in arrays.items():
        if values.ndim >= 2:
            scaled = values if scale is None or values.dtype.kind not in "iuf" else values * np.float64(scale)
            found[name] = Variable.of(name, tuple(_axes_by_length(values.shape, axes)), scaled)
    sizes: dict[str, int] = {}
    for name, variable in found.items():
        for dim, size in variable.sizes.items():
            if sizes.setdefault(dim, size) != size:
                raise InputError(f"{file}: its arrays do not fit together: {dim} of {name} is {size}, not {sizes[dim]}")
    found |= {name: Variable.of(name, (name,), values) for name, values in axes.items() if name in sizes}
    yield Dataset(found, set(axes) & set(sizes))


def _axes_by_length(shape: Sequence[int], axes: dict[str, np.ndarray]) -> list[str]:
    """Names of the axes from the last to the first: longitude last where both lengths are equal. A first axis without
    coordinate is time."""
    from .vocabulary import LATITUDE, LONGITUDE

    order = sorted(axes, key=lambda name: (name.lower() in LATITUDE | {"y"}, name.lower() in LONGITUDE | {"x"}))
    dims: list[str] = []
    for size in reversed(shape):
        fitting = [name for name in order if len(axes[name]) == size and name not in dims]
        dims.insert(0, fitting[-1] if fitting else f"axis{len(shape) - len(dims) - 1}")
    if dims[0] == "axis0" and "time" not in axes:
        dims[0] = "time"
    return dims


def _joined(path: Path, files: list[Path], datasets: list):
    """Many files as one: times one after another in one unit, variables side by side, on equal grids."""
    import xarray

    try:
        whole = xarray.combine_by_coords(
            [_in_one_unit(dataset) for dataset in datasets],
            join="exact",
            combine_attrs="override",
            data_vars="minimal",
            coords="minimal",
            compat="override",
        )
    except Exception as error:
        raise InputError(
            f"{path}: its {len(files)} files do not join ({_reason(error)}); give files of one grid whose times follow"
        ) from error
    return whole


def _in_one_unit(dataset):
    """Times in seconds since 1970 where they are dates of the common calendar: each file counts from its own start."""
    changed = {}
    for name in list(dataset.variables):
        variable = dataset[name]
        if variable.ndim != 1 or not is_time(str(name), variable) or name not in dataset.dims:
            continue
        times = times_of(dataset, str(name))
        if times.dates and times.numbers is not None and times.calendar in COMMON:
            import cftime

            dates = cftime.num2date(times.numbers, times.unit, times.calendar)
            numbers = cftime.date2num(dates, EPOCH, times.calendar)
            changed[name] = (
                name,
                np.asarray(numbers, np.float64),
                {"units": EPOCH, "calendar": times.calendar, "standard_name": "time"},
            )
    return dataset.assign_coords(changed) if changed else dataset


def _chunks(file: Path) -> dict[str, int]:
    if importlib.util.find_spec("dask") is None:
        raise InputError(f"{file}: many files at once need Dask; install it with: pip install 'stormfield[grids]'")
    return CHUNKS


def _need(file: Path, module: str, extra: str) -> None:
    if importlib.util.find_spec(module) is None:
        what = f"stormfield[{extra}]" if extra else module
        raise MissingPackageError(
            f"{file}: reading it needs the Python package {module}; install it with: pip install '{what}'", module
        )


def _matching(path: Path) -> list[Path]:
    return [Path(name) for name in sorted(glob.glob(str(path), recursive=True))]  # noqa: PTH207  (absolute patterns)


def _grids_in(folder: Path) -> list[Path]:
    files = sorted(folder.iterdir())
    if any(file.suffix.lower() in SURFACES for file in files):
        return []
    return [file for file in files if file.suffix.lower() in ENDINGS]


def _is_zarr(path: Path) -> bool:
    marks = (".zgroup", ".zmetadata", "zarr.json")
    return path.is_dir() and (path.suffix.lower() == ".zarr" or any((path / mark).exists() for mark in marks))


def _begins(path: Path, mark: bytes) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(mark)) == mark
    except OSError:
        return False


def _reason(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[0] if lines else type(error).__name__
