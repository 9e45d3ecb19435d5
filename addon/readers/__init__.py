# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets → mesh and field, by the ending of the file: read_field() and read_mesh().

    .t                the format of the thesis's data: faces vertices, triangles, positions, vectors
    folder            a baked λ cache
    .npz .nc .nc4 .h5 wind on a latitude-longitude grid, put onto a sphere
    anything else     what meshio reads (.ply, .vtk, .vtu, .obj, ...), vectors from its point data

Faults of the data are InputError naming file, place and cure. No bpy, no native module.
"""

from pathlib import Path

from ..cache.layout import OLD_STAGE, STAGE
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .choice import Choice
from .field_data import FieldData, NoFieldError
from .reading import ArrayInfo, Reading

GRIDS = {".npz", ".nc", ".nc4", ".cdf", ".h5"}
#: Faces of the sphere that carries wind by default.
SPHERE_FACES = 20480


def read_field(path: str | Path, choice: Choice | None = None) -> FieldData:
    """The field of any of the files above. choice: what of it, where it offers more than one."""
    path, choice = _existing(path), choice or Choice()
    ending = path.suffix.lower()
    if _is_cache(path):
        from .cache_folder import read_cache

        return read_cache(path, choice.attribute)
    if ending in GRIDS:
        from .wind import read_wind

        return read_wind(path, SPHERE_FACES if choice.sphere_faces is None else choice.sphere_faces)
    if ending == ".t":
        from .t_file import read_t

        return read_t(path)
    from .point_data import read_point_data

    return read_point_data(path, choice.vector)


def read_mesh(path: str | Path) -> tuple[MeshData, Reading]:
    """The mesh of any of the files above, whether it carries a field or not, and what there is to choose."""
    path = _existing(path)
    if _is_cache(path) or path.suffix.lower() in {".t", *GRIDS}:
        data = read_field(path)
        return data.mesh, data.read
    from .point_data import choices, read_surface

    mesh, carried = read_surface(path)
    return mesh, Reading((str(path),), choices=choices(carried))


def _is_cache(path: Path) -> bool:
    return path.is_dir() or path.name in (STAGE, OLD_STAGE)


def _existing(path: str | Path) -> Path:
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file or folder; check the name")
    return path


__all__ = ["SPHERE_FACES", "ArrayInfo", "Choice", "FieldData", "NoFieldError", "Reading", "read_field", "read_mesh"]
