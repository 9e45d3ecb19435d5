# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that VTK does not read as well as others: OFF and OBJ with fields beside them, and what meshio reads."""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..model.errors import InputError
from .beside_files import fields_beside, read_vectors
from .ply_file import read_ply
from .polygon_files import Polygons, read_obj, read_off
from .raw_surface import RawSurface, plain_surface
from .vtk_data import grid_data, need_vtk, polygon_data, surface_part, vtk_errors

#: Names of meshio → numbers of VTK, for all cells that bound or fill something.
CELL_TYPES = {
    **{"triangle": 5, "polygon": 7, "quad": 9, "tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14},
    **{"triangle6": 22, "quad8": 23, "tetra10": 24, "hexahedron20": 25, "wedge15": 26, "pyramid13": 27, "quad9": 28},
    **{"hexahedron27": 29, "wedge18": 32, "triangle7": 34},
}
NO_FACES = ("vertex", "line")


def other_parts(path: Path) -> list[RawSurface]:
    """The surface of a file and of the fields beside it. Raises InputError."""
    ending = path.suffix.lower()
    if ending == ".ply":
        ply = read_ply(path)
        return [_surface(path, Cells(ply.points, ply.polygons, None, ply.point_data, ply.face_data))]
    if ending not in (".off", ".obj"):
        return [_surface(path, _meshio_cells(path))]
    found = read_off(path) if ending == ".off" else read_obj(path)
    at_points, at_faces = _fields_beside(path, found)
    return [_surface(path, Cells(found.points, found.polygons, None, at_points, at_faces))]


@dataclass(frozen=True, eq=False)
class Cells:
    """What a file has: cells, each the numbers of its corners; types: those of VTK, None for polygons alone; data of
    points and of cells by name."""

    points: np.ndarray
    cells: list[np.ndarray]
    types: np.ndarray | None
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray]


def _surface(path: Path, found: Cells) -> RawSurface:
    """Triangles and quads are cut here, so that they need nothing that Blender lacks; the rest by VTK."""
    plain = all(len(cell) in (3, 4) for cell in found.cells) if found.types is None else _flat(found.types).all()
    if plain:
        return plain_surface(found.points, found.cells, found.point_data, found.cell_data)
    need_vtk(str(path))
    with vtk_errors(str(path)):
        if found.types is None:
            data = polygon_data(found.points, found.cells, found.point_data, found.cell_data)
        else:
            data = grid_data(found.points, found.cells, found.types, found.point_data, found.cell_data)
        return surface_part(data, "", str(path))


def _flat(types: np.ndarray) -> np.ndarray:
    return np.isin(types, (CELL_TYPES["triangle"], CELL_TYPES["quad"]))


def _fields_beside(path: Path, found: Polygons) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Of points and of faces. Fields beside a mesh are of either, by their number of rows; where both fit, of both."""
    at_points, at_faces = dict(found.point_data), {}
    for file in fields_beside(path):
        for name, vectors in read_vectors(file).items():
            rows, faces, points = len(vectors), len(found.polygons), len(found.points)
            if rows not in (faces, points):
                raise InputError(f"{file}: has {rows} vectors, but {path.name} has {faces} faces and {points} vertices")
            if rows == faces:
                at_faces[name] = vectors
            if rows == points:
                at_points[name] = vectors
    return at_points, at_faces


def _meshio_cells(path: Path) -> Cells:
    found = _meshio(path)
    points = np.asarray(found.points, np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise InputError(f"{path}: has points of shape {points.shape}; give x, y and z")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    unknown = [b.type for b in found.cells if b.type not in CELL_TYPES and not b.type.startswith(NO_FACES)]
    if unknown:
        raise InputError(f"{path}: has cells of type {unknown[0]}, which are not known; convert it to .vtu")
    used = [k for k, block in enumerate(found.cells) if block.type in CELL_TYPES and len(block.data)]
    cells = [np.asarray(row, np.int64) for k in used for row in found.cells[k].data]
    if not cells:
        raise InputError(f"{path}: has no faces; give a surface of triangles")
    types = np.repeat([CELL_TYPES[found.cells[k].type] for k in used], [len(found.cells[k].data) for k in used])
    per_cell = {
        name: np.concatenate([np.asarray(blocks[k], np.float64).reshape(len(blocks[k]), -1) for k in used])
        for name, blocks in found.cell_data.items()
    }
    per_point = {name: np.asarray(values).reshape(len(points), -1) for name, values in found.point_data.items()}
    return Cells(points, cells, types, per_point, per_cell)


def _meshio(path: Path) -> Any:
    import meshio

    said = io.StringIO()
    try:
        # meshio announces problems on standard output and by SystemExit.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(path)
    except (Exception, SystemExit) as error:
        raise InputError(f"{path}: is not a mesh that can be read ({_reason(error, said.getvalue())})") from error


def _reason(error: BaseException, said: str) -> str:
    """What meshio says, on one line: as an exception or as a print before it ends the process."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    if not lines or lines[0].isdigit():
        lines = [line.strip() for line in said.splitlines() if line.strip()]
    return " ".join(lines)[:200].removeprefix("Error: ") or "no format fits its content"
