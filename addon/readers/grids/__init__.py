# SPDX-License-Identifier: GPL-3.0-or-later
"""Wind and currents on grids → a field on a surface: NetCDF, GRIB, zarr, .npz; one file, a folder, or a pattern.

    opening      files → one dataset
    components   which two variables are one vector
    axes, times  one level and member; times become λ
    places       where the values lie → a Grid: Globe, Patch, Plane, Nodes, Cells
    missing, samples   values that are none; one time after another
    surface      Grid → its mesh, and vectors at the vertices

The mesh is a sphere of radius `radius`, in metres, so that speeds are metres per second and rates 1/s.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...model.errors import InputError
from ...model.mesh_data import MeshData
from ...work import Step, Steps, run, scaled
from ..choice import Choice
from ..field_data import FieldData, lambdas_of
from ..geography import COMMON, Geography
from ..reading import ArrayInfo, Reading
from .axes import Selection, select
from .components import Pair, choose_pair, find_pairs
from .opening import files_of, is_grid, open_grid
from .places import find_grid
from .samples import Components, GridSamples, Scan, scan
from .surface import Grid, Resolution, Surface
from .times import Times, decoded, times_of, within
from .vocabulary import is_latitude, is_longitude, speed_of, unit

#: Part of the steps in which times are read.
SCANNED = 0.8


def grid_steps(path: Path, choice: Choice) -> Steps[FieldData]:
    """The field of a grid. Raises InputError that names the file, what is wrong and the cure."""
    where = str(path)
    yield Step(0.0, f"Opening {path.name}")
    with open_grid(path) as dataset:
        variables = _outside_groups(dataset, where)
        pair = choose_pair(variables, choice.vector, where)
        grid = find_grid(dataset, pair, where)
        horizontal = _horizontal(variables, pair, grid)
        selection = select(dataset, variables[pair.east], horizontal, choice.by_dimension, where)
        times, chosen = _times(dataset.isel(selection.fixed), selection, choice, where)
        said = _said(variables, pair, dataset)
    components = Components(
        functools.partial(open_grid, path), pair, grid.dims, selection.fixed, selection.over, chosen, said.speed, where
    )
    found = yield from scaled(scan(components), 0.0, SCANNED)
    if found.empty:
        raise InputError(f"{where}: {_labels(times, found.empty)} without any value; leave out with --times")
    yield Step(SCANNED, "Making the mesh")
    surface = _surface(grid, found, choice, where)
    numbers = times.numbers if times.numbers is not None else np.arange(len(chosen), dtype=np.float64)
    return FieldData(
        _sized(surface, choice),
        lambdas_of(numbers, where),
        GridSamples(found.samples, surface),
        _reading(path, said, selection, times, surface, found, choice),
        Geography(surface.spherical, times.numbers, times.unit, times.calendar if times.dates else ""),
        None if found.valid.all() else functools.partial(_whole_mesh, grid, found, choice, where),
    )


def read_grid_mesh(path: Path) -> tuple[MeshData, Reading]:
    """The mesh of a grid whose field is not chosen yet, and what there is to choose."""
    where = str(path)
    with open_grid(path) as dataset:
        variables = _outside_groups(dataset, where)
        pair = next(iter(find_pairs(variables)), None)
        if pair is None:
            raise InputError(f"{where}: has no vectors on a grid; it has {', '.join(variables) or 'nothing'}")
        grid = find_grid(dataset, pair, where)
        horizontal = _horizontal(variables, pair, grid)
        first = {str(dim): 0 for dim in variables[pair.east].dims if str(dim) not in horizontal}
        said = _said(variables, pair, dataset)
    opened = functools.partial(open_grid, path)
    found = run(scan(Components(opened, pair, grid.dims, first, None, np.zeros(1, np.int64), said.speed, where)))
    surface = _surface(grid, found, Choice(), where)
    return surface.mesh, Reading(tuple(map(str, files_of(path))), choices=said.choices)


def _sized(surface: Surface, choice: Choice) -> MeshData:
    """In metres where it is on a sphere."""
    mesh = surface.mesh
    return MeshData(mesh.vertices * choice.radius_km * 1000.0, mesh.triangles) if surface.spherical else mesh


def _whole_mesh(grid: Grid, found: Scan, choice: Choice, where: str) -> MeshData:
    """The mesh of the grid with a value everywhere."""
    u, v = (np.nan_to_num(values) for values in found.first)
    complete = replace(found, first=(u, v), valid=np.ones_like(found.valid))
    return _sized(_surface(grid, complete, choice, where), choice)


def _surface(grid: Grid, found: Scan, choice: Choice, where: str) -> Surface:
    try:
        return grid.surface(found.valid, found.first, Resolution(choice.sphere_faces))
    except InputError as fault:
        raise InputError(f"{where}: {fault}") from fault


@dataclass(frozen=True)
class _Said:
    """What the file says of the chosen pair and of others. speed: metres per second of one unit, None where the unit is
    none of speed. groups: names of those in the file."""

    arrays: tuple[ArrayInfo, ...]
    choices: tuple[ArrayInfo, ...]
    others: tuple[str, ...]
    unit: str
    speed: float | None
    staggered: bool
    groups: tuple[str, ...]


def _said(variables: dict, pair: Pair, dataset) -> _Said:
    of = unit(variables[pair.east])
    return _Said(
        tuple(_info(name, variables[name]) for name in (pair.east, pair.north)),
        tuple(_info(name, variable) for name, variable in variables.items()),
        tuple(other.names for other in find_pairs(variables) if other.names != pair.names),
        of,
        speed_of(of) if of else 1.0,
        variables[pair.east].dims != variables[pair.north].dims,
        getattr(dataset, "groups", ()),
    )


def _outside_groups(dataset, where: str) -> dict:
    """vector_variables. Raises InputError where groups of the file have them all."""
    variables, groups = vector_variables(dataset), getattr(dataset, "groups", ())
    if groups and not variables:
        raise InputError(
            f"{where}: its variables are in groups ({', '.join(groups)}), which are not read; "
            f"make a file of one with: ncks -G : -g {groups[0]} IN.nc OUT.nc"
        )
    return variables


def vector_variables(dataset) -> dict:
    """The variables that may be components: numbers on at least one dimension, no coordinates."""
    return {
        str(name): dataset[name]
        for name in dataset.data_vars
        if np.issubdtype(dataset[name].dtype, np.number)
        and dataset[name].ndim
        and not is_latitude(str(name), dataset[name])
        and not is_longitude(str(name), dataset[name])
        and "cf_role" not in dataset[name].attrs
    }


def _horizontal(variables: dict, pair: Pair, grid: Grid) -> set[str]:
    """Dimensions of place: of the grid, and those that only one component of a staggered grid has."""
    east, north = (set(map(str, variables[name].dims)) for name in (pair.east, pair.north))
    return set(grid.dims) | (east ^ north)


def _times(dataset, selection: Selection, choice: Choice, where: str) -> tuple[Times, np.ndarray]:
    """The times of the samples, and their places along their dimension."""
    if selection.over is None:
        times = _scalar_time(dataset)
        if choice.times is not None:
            within(times, *choice.times, where)
        return times, np.zeros(1, np.int64)
    times = times_of(dataset, selection.over)
    if choice.times is not None:
        chosen = within(times, *choice.times, where)
    else:
        chosen = np.arange(dataset.sizes[selection.over])
    times = times[chosen]
    if times.numbers is not None and len(chosen) > 1:
        order = np.argsort(times.numbers, kind="stable")
        times, chosen = times[order], chosen[order]
    return times, chosen


def _scalar_time(dataset) -> Times:
    """The time of a dataset whose variables have none: a coordinate of one value."""
    for name in ("valid_time", "time"):
        if name in dataset.variables and dataset[name].ndim == 0:
            return decoded(dataset[name])
    return Times(None)


def _labels(times: Times, samples: tuple[int, ...]) -> str:
    labels = times.dates or tuple(f"{number:g}" for number in times.numbers or ())
    names = [labels[j] if labels else f"sample {j}" for j in samples]
    return f"{', '.join(names[:3])}{' …' if len(names) > 3 else ''} {'is' if len(names) == 1 else 'are'}"


def _reading(
    path: Path, said: _Said, selection: Selection, times: Times, surface: Surface, found: Scan, choice: Choice
) -> Reading:
    standard = times.calendar in COMMON
    calendar = "" if standard else f"calendar {times.calendar}"
    return Reading(
        files=tuple(map(str, files_of(path))),
        arrays=said.arrays,
        choices=said.choices,
        selected=selection.said,
        times=times.dates or (() if times.numbers is None else tuple(times.numbers.tolist())),
        time_unit=calendar if times.dates else times.unit,
        unit="m/s" if said.speed is not None else said.unit,
        changes=surface.changes,
        notes=tuple(_notes(said, selection, times, surface, found, choice)),
    )


def _notes(
    said: _Said, selection: Selection, times: Times, surface: Surface, found: Scan, choice: Choice
) -> Iterator[str]:
    """What was guessed, left out or is to be known, each a clause."""
    yield from surface.notes
    if said.staggered:
        yield "a staggered grid: components averaged to the middle of its cells"
    if said.groups:
        yield f"groups of the file are not read: {', '.join(said.groups)}"
    if said.others:
        yield f"other vectors to choose: {'; '.join(said.others)}"
    if not said.unit:
        yield "the file gives no unit: taken as metres per second"
    elif said.speed is None:
        yield f"{said.unit} is no speed: rates and periods are not seconds"
    elif said.speed != 1.0:
        yield f"converted from {said.unit}"
    if times.numbers is None:
        yield "no times in the file" + (": λ is even over the samples" if selection.over else "")
    if found.marks:
        yield f"undeclared {', '.join(f'{mark:g}' for mark in found.marks)} taken as no value"
    if found.varying:
        yield f"{found.varying} grid points miss their value at some times and are left out at all"
    if found.zero > 0.01 * found.valid.size:
        yield f"{found.zero} grid points are zero at all times; if that is land, declare it as missing"
    yield f"radius {choice.radius_km:g} km" if surface.spherical else "lengths in metres"


def _info(name: str, variable) -> ArrayInfo:
    return ArrayInfo(name, " × ".join(f"{dim} {size}" for dim, size in variable.sizes.items()), 1, unit(variable))


__all__ = ["grid_steps", "is_grid", "read_grid_mesh", "vector_variables"]
