# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that VTK reads, with the times that they hold: .vtp .vtu .vtk .vtm .vtkhdf .stl XDMF Exodus, ..."""

from __future__ import annotations

import importlib
from functools import partial
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from .raw_surface import RawSurface
from .surface_field import SurfaceTime, SurfaceTimes
from .vtk_data import leaves, need_vtk, surface_part, vtk_errors

XML = ("vtkIOXML", "vtkXMLGenericDataObjectReader")
#: The class that reads a file, by its ending.
READERS = {
    **dict.fromkeys((".vtp", ".vtu", ".vts", ".vtr", ".vti", ".vtm", ".vtmb", ".vtpc"), XML),
    ".pvtp": ("vtkIOXML", "vtkXMLPPolyDataReader"),
    ".pvtu": ("vtkIOXML", "vtkXMLPUnstructuredGridReader"),
    ".pvts": ("vtkIOXML", "vtkXMLPStructuredGridReader"),
    ".vtk": ("vtkIOLegacy", "vtkGenericDataObjectReader"),
    ".vtkhdf": ("vtkIOHDF", "vtkHDFReader"),
    ".stl": ("vtkIOGeometry", "vtkSTLReader"),
    **dict.fromkeys((".xdmf", ".xmf", ".xdmf2"), ("vtkIOXdmf2", "vtkXdmfReader")),
    **dict.fromkeys((".e", ".ex2", ".exo", ".exii"), ("vtkIOExodus", "vtkExodusIIReader")),
}
#: Switches of readers that leave data out unless they are on.
EVERYTHING = (
    *("ReadAllScalarsOn", "ReadAllVectorsOn", "ReadAllNormalsOn", "ReadAllFieldsOn", "ReadAllTensorsOn"),
    *("EnableAllPointArrays", "EnableAllCellArrays"),
)


def vtk_times(path: Path) -> SurfaceTimes:
    """All times of one file. Raises InputError where VTK is missing or cannot read it."""
    need_vtk(str(path))
    with vtk_errors(str(path)):
        reader = _reader(path)
        times = _times(reader)
    if not times:
        return SurfaceTimes(str(path), (SurfaceTime((path,), partial(_read, path, None)),))
    return SurfaceTimes(str(path), tuple(SurfaceTime((path,), partial(_read, path, time), time) for time in times))


def vtk_parts(path: Path) -> list[RawSurface]:
    """The parts of a file of one time."""
    need_vtk(str(path))
    return _read(path, None)


def _read(path: Path, time: float | None) -> list[RawSurface]:
    with vtk_errors(str(path)):
        reader = _reader(path)
        if time is None:
            reader.Update()
        else:
            reader.UpdateTimeStep(time)
        parts = [surface_part(leaf, name, str(path)) for name, leaf in leaves(reader.GetOutputDataObject(0))]
    if not parts:
        raise InputError(f"{path}: has no faces; give a surface of triangles")
    return parts


def _reader(path: Path) -> Any:
    module, name = READERS[path.suffix.lower()]
    reader = getattr(importlib.import_module(f"vtkmodules.{module}"), name)()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    if hasattr(reader, "SetAllArrayStatus"):
        for kind in (reader.NODAL, reader.ELEM_BLOCK, reader.SIDE_SET):
            reader.SetAllArrayStatus(kind, 1)
    for switch in EVERYTHING:
        if hasattr(reader, switch):
            getattr(reader, switch)()
    return reader


def _times(reader: Any) -> list[float]:
    """The times of a file that holds several."""
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

    about = reader.GetOutputInformation(0)
    times = about.Get(Pipeline.TIME_STEPS()) if about.Has(Pipeline.TIME_STEPS()) else ()
    return [float(time) for time in times or ()]
