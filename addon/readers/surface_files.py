# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files are one surface over time: one file, a collection (.pvd, .series), numbered files, a folder of them."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from ..model.errors import InputError
from .beside_files import ENDINGS as BESIDE
from .beside_files import mesh_beside
from .other_surfaces import other_parts
from .raw_surface import RawSurface
from .surface_field import SurfaceTime, SurfaceTimes
from .vtk_data import have_vtk
from .vtk_files import READERS, vtk_parts, vtk_times

#: Formats of VTK that meshio reads too, where VTK is not installed.
ALSO_BY_MESHIO = (".vtu", ".vtk", ".stl", ".xdmf")
COLLECTIONS = (".pvd", ".series")
#: Endings that a folder is searched for.
SURFACES = {*READERS, ".ply", ".off", ".obj"} - {".stl"}
#: The last number of a name, with its decimals.
NUMBER = re.compile(r"(\d+(?:\.\d+)?)(?=\D*$)")


def surface_times(path: Path) -> SurfaceTimes:
    """The times of a file or folder, in order. Raises InputError."""
    ending = path.suffix.lower()
    if not path.exists():
        return _pattern_times(path)
    if path.is_dir():
        return folder_times(path)
    if ending == ".pvd":
        return _collection(path, _pvd(path))
    if ending == ".series":
        return _collection(path, _series(path))
    if ending in BESIDE:
        return surface_times(mesh_beside(path))
    if _by_vtk(path):
        return vtk_times(path)
    return SurfaceTimes(str(path), (SurfaceTime((path,), partial(other_parts, path)),))


def numbered_times(path: Path) -> SurfaceTimes:
    """The times of a file, or of all files in its folder that differ from it in the number alone."""
    times = surface_times(path)
    family = _family(path) if path.is_file() else []
    if len(times.times) > 1 or len(family) < 2:
        return times
    return series_of(family, str(path), (f"{len(family)} numbered files beside {path.name} are its times",))


def series_of(files: Sequence[Path], name: str, notes: tuple[str, ...] = ()) -> SurfaceTimes:
    """One time for each file, by the numbers in their names."""
    numbered = sorted(((_number(file), file) for file in files), key=lambda pair: (pair[0] is None, pair[0], pair[1]))
    times = tuple(SurfaceTime((file,), partial(_parts, file), number=number) for number, file in numbered)
    return SurfaceTimes(name, times, notes=notes)


def folder_times(folder: Path) -> SurfaceTimes:
    """A folder with one collection, one family of numbered files, or folders named by times with a file each."""
    collections = sorted(file for file in folder.iterdir() if file.suffix.lower() in COLLECTIONS)
    if len(collections) == 1:
        return surface_times(collections[0])
    families = {_stem(file): _family(file) for file in sorted(folder.iterdir()) if file.suffix.lower() in SURFACES}
    if len(families) == 1 and not collections:
        (family,) = families.values()
        return series_of(family, str(folder)) if len(family) > 1 else surface_times(family[0])
    timed = _folders_of_times(folder)
    if len(timed) > 1 and not families:
        times = tuple(SurfaceTime((file,), partial(_parts, file), time=time) for time, file in timed)
        return SurfaceTimes(str(folder), times)
    found = [*(file.name for file in collections), *families]
    if found:
        raise InputError(
            f"{folder}: has several data sets, {', '.join(found)}; give one of them, or a pattern in quotes"
        )
    raise InputError(f"{folder}: has no data, and no finished cache (manifest.json is missing); solve or bake first")


def _pattern_times(pattern: Path) -> SurfaceTimes:
    files = sorted(pattern.parent.glob(pattern.name))
    if not files:
        raise InputError(f"{pattern}: no file has such a name; check the pattern")
    return series_of(files, str(pattern)) if len(files) > 1 else surface_times(files[0])


def _parts(file: Path) -> list[RawSurface]:
    return vtk_parts(file) if _by_vtk(file) else other_parts(file)


def _by_vtk(file: Path) -> bool:
    """Without VTK, as inside Blender, meshio reads plain surfaces of some formats."""
    ending = file.suffix.lower()
    return ending in READERS and (have_vtk() or ending not in ALSO_BY_MESHIO)


def _pvd(path: Path) -> list[tuple[float | None, str]]:
    try:
        entries = ElementTree.parse(path).getroot().iter("DataSet")
        return [(_number_or_none(entry.get("timestep")), entry.get("file", "")) for entry in entries]
    except (ElementTree.ParseError, OSError, ValueError) as error:
        raise InputError(f"{path}: is not a .pvd collection ({error})") from error


def _series(path: Path) -> list[tuple[float | None, str]]:
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))["files"]
        return [(_number_or_none(entry.get("time")), entry["name"]) for entry in entries]
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: is not a .series collection ({error})") from error


def _collection(path: Path, entries: list[tuple[float | None, str]]) -> SurfaceTimes:
    """Files of the same time are parts of one surface."""
    if not entries:
        raise InputError(f"{path}: names no files")
    files_at: dict[float | None, list[Path]] = {}
    for time, name in entries:
        file = path.parent / name
        if not file.exists():
            raise InputError(f"{path}: names {name}, which is not there; put it beside the collection")
        files_at.setdefault(time, []).append(file)
    if None in files_at and len(files_at[None]) > 1:
        return series_of([path.parent / name for _, name in entries], str(path))
    ordered = sorted(files_at.items(), key=lambda item: item[0] if item[0] is not None else 0.0)
    return SurfaceTimes(
        str(path), tuple(SurfaceTime(tuple(files), partial(_all_parts, files), time) for time, files in ordered)
    )


def _all_parts(files: Sequence[Path]) -> list[RawSurface]:
    return [part for file in files for part in _parts(file)]


def _family(path: Path) -> list[Path]:
    """The files of the folder whose names differ from this in the number alone."""
    if _number(path) is None:
        return [path]
    same = [other for other in path.parent.iterdir() if other.suffix == path.suffix and _number(other) is not None]
    return sorted(other for other in same if _stem(other) == _stem(path))


def _folders_of_times(folder: Path) -> list[tuple[float, Path]]:
    """(time, the one surface in the folder of that name), as OpenFOAM writes them."""
    found = []
    for inner in folder.iterdir():
        time = _number_or_none(inner.name) if inner.is_dir() else None
        files = [file for file in inner.iterdir() if file.suffix.lower() in SURFACES] if time is not None else []
        if len(files) == 1 and time is not None:
            found.append((time, files[0]))
    return sorted(found)


def _number(path: Path) -> float | None:
    found = NUMBER.search(path.name.removesuffix(path.suffix))
    return float(found[1]) if found else None


def _stem(path: Path) -> str:
    """The name with # for its number."""
    return NUMBER.sub("#", path.name.removesuffix(path.suffix), count=1) + path.suffix


def _number_or_none(word: object) -> float | None:
    try:
        return float(str(word))
    except ValueError:
        return None
