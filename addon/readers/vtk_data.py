# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's data objects → surfaces of triangles, by VTK's own filters: second order cells, strips, polygons and volumes.

    with vtk_errors(path): part = surface_part(data, "wall", str(path))

VTK is imported inside the functions, since inside Blender there is none.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np

from ..model.errors import InputError
from .raw_surface import RawSurface

#: Types of unstructured cells that are polygons of a surface as they are: triangle, polygon, quad.
FLAT_TYPES = (5, 7, 9)


def need_vtk(where: str) -> None:
    """Raises InputError where VTK is not installed."""
    if not have_vtk():
        raise InputError(f"{where}: is read through VTK, which is not installed here: pip install vtk")


def have_vtk() -> bool:
    """Whether VTK can be loaded; Blender's users do not have it."""
    try:
        import vtkmodules.vtkCommonCore  # noqa: F401
    except ImportError:
        return False
    return True


@contextmanager
def vtk_errors(where: str) -> Iterator[None]:
    """What VTK would print becomes an InputError that names the file; half a file is not taken for a whole one."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    before, said = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    vtkOutputWindow.SetInstance(said)
    try:
        yield
    finally:
        vtkOutputWindow.SetInstance(before)
        vtkLogger.SetStderrVerbosity(verbosity)
    reason = _first_error(said.GetOutput())
    if reason:
        raise InputError(f"{where}: cannot be read ({reason}); write it again, or convert it to .vtp or .vtu")


def _first_error(text: str) -> str:
    """The sentence of the first error: the line after "ERROR: In ...", without the address of the object."""
    lines = text.splitlines()
    for line, after in pairwise(lines):
        if line.startswith("ERROR:"):
            return after.split("): ", 1)[-1].strip().rstrip(".")
    return ""


def leaves(data: Any) -> list[tuple[str, Any]]:
    """The data sets of a data object by name; a composite one has several."""
    from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet

    if data is None:
        return []
    if not data.IsA("vtkCompositeDataSet"):
        return [("", data)] if data.IsA("vtkDataSet") else []
    found, walk = [], data.NewIterator()
    walk.InitTraversal()
    while not walk.IsDoneWithTraversal():
        about = walk.GetCurrentMetaData() if walk.HasCurrentMetaData() else None
        name = about.Get(vtkCompositeDataSet.NAME()) if about is not None else None
        found += [(name or f"block {walk.GetCurrentFlatIndex()}", walk.GetCurrentDataObject())]
        walk.GoToNextItem()
    return [(name, leaf) for name, leaf in found if leaf.IsA("vtkDataSet")]


def surface_part(data: Any, name: str, where: str) -> RawSurface:
    """The surface of one data set. Where it holds surface cells those are it, else the outside of its volume cells; the
    cells that are left out are counted. where: the file. Raises InputError."""
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter

    ghosts = data.GetNumberOfCells()
    if data.HasAnyGhostCells() and hasattr(data, "RemoveGhostCells"):
        data.RemoveGhostCells()
    ghosts -= data.GetNumberOfCells()
    polygons, changes, volume = _polygons(data)
    cut = vtkTriangleFilter()
    cut.PassVertsOff()
    cut.PassLinesOff()
    cut.SetInputData(polygons)
    cut.Update()
    found = cut.GetOutput()
    points, triangles = _points(found), _triangles(found)
    corners = np.diff(_ends(polygons.GetPolys()))
    wanted = int((corners - 2).sum() + (np.diff(_ends(polygons.GetStrips())) - 2).sum())
    dropped = wanted - len(triangles)
    if dropped > 0 and dropped > _edges_without_length(polygons):
        raise InputError(f"{where}: {dropped} triangles of polygons that cross themselves are missing; repair those")
    other = int((corners > 3).sum()) + polygons.GetNumberOfStrips()
    changes |= {"polygons or strips cut into triangles": other, "faces without area dropped": dropped}
    changes["ghost cells, which other parts have too, left out"] = ghosts
    return RawSurface(
        name=name,
        points=points,
        triangles=triangles,
        point_data=_arrays(found.GetPointData(), len(points)),
        cell_data=_arrays(found.GetCellData(), len(triangles)),
        units=_units(found.GetPointData()) | _units(found.GetCellData()),
        volume=volume,
        time=_time(data),
        changes=changes,
    )


def _polygons(data: Any) -> tuple[Any, dict[str, int], bool]:
    """vtkPolyData of the surface of a data set, what was done for it, and whether it is the outside of a volume."""
    if data.IsA("vtkPolyData"):
        return _without_lines(data), {}, False
    if not data.IsA("vtkUnstructuredGrid"):
        volume = data.GetNumberOfCells() > 0 and data.GetCell(0).GetCellDimension() == 3
        return (
            _outside(data),
            {"volume cells whose outside is taken": data.GetNumberOfCells()} if volume else {},
            volume,
        )
    types = _types(data)
    dimension, linear = _dimensions(types)
    if (dimension == 2).any():
        chosen = dimension == 2
        changes = {"volume cells left out beside the surface": int((dimension == 3).sum())}
        flat = data if chosen.all() else _cells(data, chosen)
        if np.isin(types[chosen], FLAT_TYPES).all():
            return _as_polygons(flat), changes, False
    else:
        chosen = dimension == 3
        changes, flat = {"volume cells whose outside is taken": int(chosen.sum())}, data
    # Beside a linear cell a second order one is taken by its corners: its middles would lie on edges without a vertex.
    curved = int((~linear[chosen]).sum())
    cuts = 1 if curved == chosen.sum() else 0
    word = "cells of second order cut" if cuts else "cells of second order taken by their corners"
    return _outside(flat, cuts), changes | {word: curved}, not (dimension == 2).any()


def _without_lines(data: Any) -> Any:
    """Polygons and strips alone, with their data, which come after those of points and lines."""
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    before = data.GetNumberOfVerts() + data.GetNumberOfLines()
    if not before:
        return data
    kept = vtkPolyData()
    kept.SetPoints(data.GetPoints())
    kept.SetPolys(data.GetPolys())
    kept.SetStrips(data.GetStrips())
    kept.GetPointData().ShallowCopy(data.GetPointData())
    values = _arrays(data.GetCellData(), data.GetNumberOfCells())
    _add_arrays(kept, {}, {name: numbers[before:] for name, numbers in values.items()})
    return kept


def _ends(cells: Any) -> np.ndarray:
    """Where the corners of each cell end, and 0 before them."""
    return _numpy(cells.GetOffsetsArray()) if cells.GetNumberOfCells() else np.zeros(1, np.int64)


def _edges_without_length(polygons: Any) -> int:
    """Sides of polygons whose ends coincide, each of which costs a triangle."""
    ends = _ends(polygons.GetPolys())
    if len(ends) < 2:
        return 0
    corners = _numpy(polygons.GetPolys().GetConnectivityArray())
    after = np.arange(1, len(corners) + 1)
    after[ends[1:] - 1] = ends[:-1]
    places = _points(polygons)[corners]
    length = np.abs(places - places[after]).max(axis=1)
    return int((length <= 1e-9 * length.max(initial=0.0)).sum())


def _dimensions(types: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each cell the dimension, and whether it is linear."""
    from vtkmodules.vtkCommonDataModel import vtkGenericCell

    cell, dimension, linear = vtkGenericCell(), np.zeros(256, np.int8), np.ones(256, bool)
    for kind in np.unique(types):
        cell.SetCellType(int(kind))
        dimension[kind], linear[kind] = cell.GetCellDimension(), cell.IsLinear()
    return dimension[types], linear[types]


def _cells(data: Any, keep: np.ndarray) -> Any:
    """The cells that are kept, (c,) booleans, on all of the points; their order stays."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    counts = np.diff(_numpy(data.GetCells().GetOffsetsArray()))
    corners = _numpy(data.GetCells().GetConnectivityArray())[np.repeat(keep, counts)]
    ends = np.concatenate([[0], np.cumsum(counts[keep])])
    cells, kept = _vtk_cell_array(ends, corners), vtkUnstructuredGrid()
    kept.SetPoints(data.GetPoints())
    kept.SetCells(numpy_to_vtk(_types(data)[keep], 1), cells)
    kept.GetPointData().ShallowCopy(data.GetPointData())
    _add_arrays(kept, {}, {name: values[keep] for name, values in _arrays(data.GetCellData(), len(keep)).items()})
    return kept


def _types(data: Any) -> np.ndarray:
    try:
        return np.array(_numpy(data.GetCellTypes()))
    except TypeError:  # before VTK 9.6
        return np.array(_numpy(data.GetCellTypesArray()))


def _as_polygons(data: Any) -> Any:
    """Triangles, quads and polygons as they are, so that points keep their order."""
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    polygons = vtkPolyData()
    polygons.SetPoints(data.GetPoints())
    polygons.SetPolys(data.GetCells())
    polygons.GetPointData().ShallowCopy(data.GetPointData())
    polygons.GetCellData().ShallowCopy(data.GetCellData())
    return polygons


def _outside(data: Any, cuts: int = 0) -> Any:
    """The outer surface; cuts: of each second order face."""
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    outside = vtkDataSetSurfaceFilter()
    outside.SetNonlinearSubdivisionLevel(cuts)
    outside.SetDelegation(False)  # the other filter does not promise an order
    outside.SetInputData(data)
    outside.Update()
    return outside.GetOutput()


def polygon_data(
    points: np.ndarray,
    polygons: list[np.ndarray],
    per_point: dict[str, np.ndarray],
    per_polygon: dict[str, np.ndarray],
) -> Any:
    """vtkPolyData of polygons of any number of corners, with their data."""
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    data = vtkPolyData()
    data.SetPoints(_vtk_points(points))
    data.SetPolys(_vtk_cells(polygons))
    _add_arrays(data, per_point, per_polygon)
    return data


def grid_data(
    points: np.ndarray,
    cells: list[np.ndarray],
    types: np.ndarray,
    per_point: dict[str, np.ndarray],
    per_cell: dict[str, np.ndarray],
) -> Any:
    """vtkUnstructuredGrid of cells of any types."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    data = vtkUnstructuredGrid()
    data.SetPoints(_vtk_points(points))
    data.SetCells(numpy_to_vtk(types.astype(np.uint8), 1), _vtk_cells(cells))
    _add_arrays(data, per_point, per_cell)
    return data


def _vtk_points(points: np.ndarray) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints

    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points, np.float64), 1))
    return places


def _vtk_cells(rows: list[np.ndarray]) -> Any:
    ends = np.concatenate([[0], np.cumsum([len(row) for row in rows])])
    return _vtk_cell_array(ends, np.concatenate(rows) if rows else np.zeros(0))


def _vtk_cell_array(ends: np.ndarray, corners: np.ndarray) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(ends.astype(np.int64), 1), numpy_to_vtkIdTypeArray(corners.astype(np.int64), 1)
    )
    return cells


def _add_arrays(data: Any, per_point: dict[str, np.ndarray], per_cell: dict[str, np.ndarray]) -> None:
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for attributes, arrays in ((data.GetPointData(), per_point), (data.GetCellData(), per_cell)):
        for name, values in arrays.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), 1)
            array.SetName(name)
            attributes.AddArray(array)


def _points(data: Any) -> np.ndarray:
    return _numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.zeros((0, 3))


def _triangles(data: Any) -> np.ndarray:
    if not data.GetNumberOfPolys():
        return np.zeros((0, 3), np.int64)
    return np.array(_numpy(data.GetPolys().GetConnectivityArray()), np.int64).reshape(-1, 3)


def _arrays(attributes: Any, count: int) -> dict[str, np.ndarray]:
    """All arrays of numbers by name, (count, k)."""
    found = {}
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(k)  # None where it is of words
        if array is not None and array.GetNumberOfTuples() == count and array.GetDataTypeAsString() != "bit":
            name = array.GetName() or f"unnamed {k}"
            found[name] = np.array(_numpy(array)).reshape(count, array.GetNumberOfComponents())
    return {name: values for name, values in found.items() if not name.startswith("vtk")}


def _time(data: Any) -> float | None:
    """What the data set says of its own time."""
    for name in ("TimeValue", "TIME", "Time", "time"):
        array = data.GetFieldData().GetArray(name)
        if array is not None and array.GetNumberOfValues() == 1:
            return float(array.GetTuple1(0))
    return None


def _units(attributes: Any) -> dict[str, str]:
    from vtkmodules.vtkCommonCore import vtkDataArray

    key, found = vtkDataArray.UNITS_LABEL(), {}
    for k in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(k)
        if array is not None and array.HasInformation() and array.GetInformation().Has(key):
            found[array.GetName() or ""] = array.GetInformation().Get(key)
    return found


def _numpy(array: Any) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(array)
