# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets → mesh and field, by the ending of the file: read_field(), read_series() and read_mesh().

    .t                     the format of the thesis's data: faces vertices, triangles, positions, vectors
    cache folder           a baked λ cache
    grids                  wind or currents: NetCDF, GRIB, zarr, .npz; also a folder of them, or a pattern of names
    anything else          a surface with vectors at points or cells, as VTK or meshio read it, at one or more times

Faults of the data are InputError naming file, place and cure. No bpy, no native module.
"""

from pathlib import Path

from ..cache.layout import MANIFEST, OLD_STAGE, PLAN, STAGE
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..work import Step, Steps, run
from .choice import EARTH_RADIUS_KM, Choice, chosen_arrays
from .field_data import FieldData, NoFieldError
from .geography import Geography
from .grids.opening import is_grid, is_pattern
from .reading import ArrayInfo, Reading
from .scene_scale import SceneScale


def read_field(path: str | Path, choice: Choice | None = None) -> FieldData:
    """The field of any of the files above, over all times that the file, folder or pattern (wall_*.vtp) holds. choice:
    what of it, where it offers more than one."""
    path, choice = Path(path), choice or Choice()
    other = run(_not_a_surface(path, choice))
    if other is not None:
        return other
    from .surface_field import field_steps
    from .surface_files import surface_times

    return run(field_steps(surface_times(path), choice))


def read_series(path: str | Path, choice: Choice | None = None) -> FieldData:
    """The same, and of one of several numbered files all of them."""
    return run(series_steps(Path(path), choice or Choice()))


def series_steps(path: Path, choice: Choice) -> Steps[FieldData]:
    """read_series() in steps: a time of a grid, a file of a surface. Within one, a library of others cannot be
    stopped."""
    other = yield from _not_a_surface(path, choice)
    if other is not None:
        return other
    from .surface_field import field_steps
    from .surface_files import numbered_times

    return (yield from field_steps(numbered_times(path), choice))


def read_mesh(path: str | Path) -> tuple[MeshData, Reading]:
    """The mesh of any of the files above, whether it carries a field or not, and what there is to choose."""
    path = Path(path)
    if _is_grid(path):
        from .grids import read_grid_mesh

        return read_grid_mesh(path)
    other = run(_not_a_surface(path, Choice()))
    if other is not None:
        return other.mesh, other.read
    from .surface_field import surface_mesh
    from .surface_files import surface_times

    return surface_mesh(surface_times(path))


def _not_a_surface(path: Path, choice: Choice) -> Steps[FieldData | None]:
    """Caches, .t files and grids; None for surfaces of other programs."""
    ending = path.suffix.lower()
    if not path.exists() and not is_pattern(path):
        raise InputError(f"{path}: no such file or folder; check the name")
    if path.name in (STAGE, OLD_STAGE) or (path / MANIFEST).exists() or (path / PLAN).exists():
        from .cache_folder import read_cache

        yield Step(0.0, f"Reading {path.name}")
        choice.check_without_grid(str(path))
        if choice.vector is not None:
            raise InputError(f"{path}: is a cache, whose fields are chosen by --attribute, not by --vector")
        return read_cache(path, choice.attribute)
    if ending == ".t":
        from .t_file import read_t

        yield Step(0.0, f"Reading {path.name}")
        choice.check_without_grid(str(path))
        found = read_t(path)
        if choice.vector is not None:
            chosen_arrays(choice.vector, found.read.choices, str(path))
        return found
    if _is_grid(path):
        from .grids import grid_steps

        return (yield from grid_steps(path, choice))
    choice.check_without_grid(str(path))
    return None


def _is_grid(path: Path) -> bool:
    """Some surfaces are NetCDF files as well: their ending tells."""
    from .vtk_files import READERS

    return path.suffix.lower() not in READERS and is_grid(path)


__all__ = [
    "EARTH_RADIUS_KM",
    "ArrayInfo",
    "Choice",
    "FieldData",
    "Geography",
    "NoFieldError",
    "Reading",
    "SceneScale",
    "is_pattern",
    "read_field",
    "read_mesh",
    "read_series",
    "series_steps",
]
