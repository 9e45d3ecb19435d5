# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces with vectors at their points, in any format that meshio reads."""

import contextlib
import io
from pathlib import Path

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .choice import chosen_arrays, listed
from .field_data import FieldData, NoFieldError, steady
from .reading import ArrayInfo, Reading

#: In these data sets nx, ny, nz are the vector, not a normal.
DEFAULT_VECTOR = ("nx", "ny", "nz")


def read_point_data(path: Path, vector: str | None) -> FieldData:
    mesh, data = read_surface(path)
    offered = choices(data)
    taken = _taken(path, offered, vector)
    return steady(mesh, _vectors(path, data, taken), Reading((str(path),), taken, offered))


def choices(data: dict[str, np.ndarray]) -> tuple[ArrayInfo, ...]:
    """What the points carry, by name."""
    return tuple(ArrayInfo(name, "points", data[name][0].size if len(data[name]) else 0) for name in sorted(data))


def read_surface(path: Path) -> tuple[MeshData, dict[str, np.ndarray]]:
    """Mesh and point data; polygons become fans of triangles."""
    import meshio

    try:
        # meshio announces problems on standard output and by SystemExit.
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            found = meshio.read(path)
    except (Exception, SystemExit) as error:
        if _empty_ply(path):
            raise InputError(f"{path}: has no vertices; give a surface of triangles") from error
        reason = str(error).strip().splitlines()
        because = f" ({reason[0]})" if reason and not reason[0].isdigit() else ""
        raise InputError(
            f"{path}: is not a mesh that can be read{because}; use .t, .ply, .obj, .vtk or .vtu"
        ) from error
    triangles = [_fans(block.data) for block in found.cells if block.type in {"triangle", "quad", "polygon"}]
    if not triangles or not sum(map(len, triangles)):
        raise InputError(f"{path}: has no faces; give a surface of triangles")
    points = np.asarray(found.points, np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise InputError(f"{path}: has points of shape {points.shape}; give x, y and z")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    return MeshData(points, np.concatenate(triangles)), dict(found.point_data)


def _empty_ply(path: Path) -> bool:
    try:
        return b"element vertex 0\n" in path.read_bytes()[:4096].replace(b"\r\n", b"\n")
    except OSError:
        return False


def _fans(polygons) -> np.ndarray:
    """Each polygon as triangles around its first corner."""
    rows = [np.asarray(polygon) for polygon in polygons]
    return np.array([[row[0], row[k], row[k + 1]] for row in rows for k in range(1, len(row) - 1)], np.int32).reshape(
        -1, 3
    )


def _taken(path: Path, offered: tuple[ArrayInfo, ...], vector: str | None) -> tuple[ArrayInfo, ...]:
    if vector is not None:
        return chosen_arrays(vector, offered, str(path))
    found = _likely(offered)
    if found is None:
        raise NoFieldError(f"{path}: which array is the field? choose with --vector from: {listed(offered)}")
    return found


def _vectors(path: Path, data: dict[str, np.ndarray], taken: tuple[ArrayInfo, ...]) -> np.ndarray:
    names = [array.name for array in taken]
    columns = [np.asarray(data[name], np.float64).reshape(len(data[name]), -1) for name in names]
    vectors = np.concatenate(columns, axis=1)
    if vectors.shape[1] == 2:
        vectors = np.column_stack([vectors, np.zeros(len(vectors))])
    if vectors.shape[1] != 3:
        raise InputError(f"{path}: {', '.join(names)} gives {vectors.shape[1]} numbers per vertex; name a vector of 3")
    return vectors


def _likely(offered: tuple[ArrayInfo, ...]) -> tuple[ArrayInfo, ...] | None:
    """The only vector there is, or nx, ny, nz."""
    triple = tuple(array for name in DEFAULT_VECTOR for array in offered if array.name == name)
    if len(triple) == len(DEFAULT_VECTOR):
        return triple
    vectors = tuple(array for array in offered if array.components == 3)
    return vectors if len(vectors) == 1 else None
