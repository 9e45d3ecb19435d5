# SPDX-License-Identifier: GPL-3.0-or-later
"""The times of a surface's data → mesh and field: choose the arrays, join the points, average cells, and say so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..work import Step, Steps
from .choice import Choice
from .field_data import FieldData, NoFieldError, check_numbers, lambdas_of
from .normals import faces_to_vertices, rotated, tangent_share, vertex_normals
from .raw_surface import CELLS, RawSurface, Values, joined, offered
from .reading import Reading
from .surface_vector import Taken, field_arrays, looks_normal, marked, normal_fault, three_components
from .weld import Welded, weld

#: Part of the steps in which files are read.
READ = 0.8
#: A surface that moves farther than this part of its size is not one surface over time.
LARGEST_MOTION = 0.1


@dataclass(frozen=True)
class SurfaceTime:
    """One time of the data. read gives its parts, the blocks of a file or the files of a time. time: as a collection
    says; number: in the name of the file, which stands for a time where there is none."""

    files: tuple[Path, ...]
    read: Callable[[], list[RawSurface]]
    time: float | None = None
    number: float | None = None


@dataclass(frozen=True)
class SurfaceTimes:
    """All times of the data, in their order. name: what messages call them."""

    name: str
    times: tuple[SurfaceTime, ...]
    time_unit: str = ""
    notes: tuple[str, ...] = ()


def surface_mesh(data: SurfaceTimes) -> tuple[MeshData, Reading]:
    """The mesh alone, and what there is to choose."""
    parts = _parts(data.times[0])
    values = joined(parts, ())
    welded = weld(values.points, values.triangles, ())
    read = Reading(_files(data), choices=offered(parts), changes=_changes(parts, welded), notes=data.notes)
    return _mesh(welded, data.name), read


def field_steps(data: SurfaceTimes, choice: Choice) -> Steps[FieldData]:
    """The field over all times. Raises InputError, and NoFieldError where nothing says which array it is."""
    yield _reading(data, 0)
    first = _parts(data.times[0])
    taken = field_arrays(first, choice.vector, data.name)
    parts = [part for part in first if part.has(taken.arrays)]
    frames, times = [_values(first, taken, data.times[0].files)], [_time(data.times[0], first)]
    for j, step in enumerate(data.times[1:], start=1):
        yield _reading(data, j)
        found = _parts(step)
        frames.append(_values(found, taken, step.files))
        times.append(_time(step, found))
    yield Step(READ, "Making the mesh")
    clock = _clock(data, times)
    _check_same_surface(frames, data)
    check_numbers(f"{data.name}: ", "field", np.array([np.abs(frame.vectors).max() for frame in frames]))
    at_cells = taken.arrays[0].location == CELLS
    points, triangles = frames[0].points, frames[0].triangles
    welded = weld(points, triangles, () if at_cells else [frame.vectors for frame in frames])
    mesh = _mesh(welded, data.name)
    _check_joined(welded, data.name)
    vectors = np.stack([_at_vertices(frame, welded, at_cells) for frame in frames])
    motion = _motion(frames)
    if motion:
        vectors = _on_first_surface(vectors, frames, welded)
    share = _share(mesh, vectors)
    if share is not None and looks_normal(share, vectors[0]):
        raise NoFieldError(f"{data.name}: {normal_fault(taken.arrays, offered(first))}")
    left = [part.name for part in first if not part.has(taken.arrays)]
    notes = [*data.notes, *taken.notes, *clock.notes]
    notes += [f"blocks without {taken.arrays[0].name} left out: {', '.join(left)}"] if left else []
    notes += [f"the surface moves by up to {motion:.2g} of its size, the first one is used"] if motion else []
    changes = _changes(parts, welded) | ({"cells averaged to points": len(triangles)} if at_cells else {})
    read = Reading(
        files=_files(data),
        arrays=taken.arrays,
        choices=offered(first),
        times=clock.times,
        time_unit=data.time_unit,
        unit=_unit(taken),
        changes=changes,
        notes=tuple(notes),
        tangent_share=share,
    )
    return FieldData(mesh, clock.lambdas, vectors, read)


def _reading(data: SurfaceTimes, j: int) -> Step:
    count = len(data.times)
    return Step(READ * j / count, f"Reading time {j + 1} of {count}" if count > 1 else f"Reading {data.name}")


def _parts(step: SurfaceTime) -> list[RawSurface]:
    """The parts with faces, each once."""
    found: list[RawSurface] = []
    read = step.read()
    flat = any(not part.volume and len(part.triangles) for part in read)
    for part in read:
        if len(part.triangles) and not (flat and part.volume) and not any(_same_block(part, other) for other in found):
            found.append(part)
    if not found:
        raise InputError(f"{_named(step.files)}: has no faces; give a surface of triangles")
    for part in found:
        used = np.zeros(len(part.points), bool)
        used[part.triangles] = True
        lost = np.flatnonzero(used & ~np.isfinite(part.points).all(axis=1))
        if len(lost):
            raise InputError(f"{_named(step.files)}: point {lost[0]} has no finite position")
        check_numbers(f"{_named(step.files)}: ", "mesh", part.points[used])
    return found


def _same_block(part: RawSurface, other: RawSurface) -> bool:
    return np.array_equal(part.triangles, other.triangles) and np.array_equal(part.points, other.points)


def _values(parts: Sequence[RawSurface], taken: Taken, files: Sequence[Path]) -> Values:
    where = _named(files)
    carrying = [part for part in parts if part.has(taken.arrays)]
    if not carrying:
        raise InputError(f"{where}: has no array '{taken.arrays[0].name}', which the first file has")
    if len({array.location for array in taken.arrays}) > 1:
        raise InputError(f"{where}: {' and '.join(map(str, taken.arrays))} are at different places; name one place")
    values = joined(carrying, taken.arrays)
    vectors = three_components(values.vectors, taken.arrays, values.points, where)
    at_cells = taken.arrays[0].location == CELLS
    used = np.full(len(vectors), at_cells)
    if not at_cells:
        used[values.triangles] = True
        vectors[~used] = 0.0
    bad = np.flatnonzero(~np.isfinite(vectors).all(axis=1))
    if len(bad):
        element = f"{'cell' if at_cells else 'point'} {bad[0]}"
        raise InputError(
            f"{where}: the vector of {element} is not finite ({len(bad)} of {used.sum()} are not); repair it"
        )
    none = np.flatnonzero(used & marked(vectors))
    if len(none):
        first = f"{'cell' if at_cells else 'point'} {none[0]}"
        raise InputError(
            f"{where}: {len(none)} of {used.sum()} vectors, the first at {first}, are "
            f"{vectors[none[0], 0]:g} in every component, which stands for no value; remove their faces, or repair them"
        )
    return Values(values.points, values.triangles, vectors)


def _check_same_surface(frames: Sequence[Values], data: SurfaceTimes) -> None:
    for frame, step in zip(frames[1:], data.times[1:], strict=True):
        if frame.points.shape != frames[0].points.shape or not np.array_equal(frame.triangles, frames[0].triangles):
            raise InputError(
                f"{_named(step.files)}: has other faces than {_named(data.times[0].files)}; paths are followed on one "
                "mesh: interpolate the data onto one"
            )
    motion = _motion(frames)
    if motion > LARGEST_MOTION:
        raise InputError(
            f"{data.name}: the surface moves by {motion:.2g} of its size; interpolate the data onto one that rests"
        )


def _motion(frames: Sequence[Values]) -> float:
    """The largest way of a point, as a part of the size; 0 where it is rounding."""
    first = frames[0].points
    size = float(np.linalg.norm(np.ptp(first, axis=0)))
    moved = max((float(np.abs(frame.points - first).max()) for frame in frames[1:]), default=0.0)
    return moved / size if moved > 1e-6 * size else 0.0


def _check_joined(welded: Welded, name: str) -> None:
    """A heap of single faces is no surface, and has no topology to find."""
    faces = len(welded.triangles)
    if faces >= 8 and len(welded.points) >= 2.9 * faces:
        raise InputError(
            f"{name}: has {faces} faces that share no points; join them (merge by distance) before writing"
        )


def _at_vertices(frame: Values, welded: Welded, at_cells: bool) -> np.ndarray:
    if at_cells:
        return faces_to_vertices(welded.points, welded.triangles, frame.vectors[welded.faces])
    return welded.mean(frame.vectors)


def _on_first_surface(vectors: np.ndarray, frames: Sequence[Values], welded: Welded) -> np.ndarray:
    """The vectors of each time turned as its tangent planes turn into those of the first."""
    source = np.full(len(welded.points), 0)
    source[welded.number[welded.number >= 0]] = np.flatnonzero(welded.number >= 0)
    normals = [vertex_normals(frame.points[source].astype(np.float64), welded.triangles) for frame in frames]
    return np.stack([rotated(v, normal, normals[0]) for v, normal in zip(vectors, normals, strict=True)])


def _mesh(welded: Welded, name: str) -> MeshData:
    if not len(welded.triangles):
        raise InputError(f"{name}: all of its faces are without area")
    return MeshData(welded.points, welded.triangles)


def _share(mesh: MeshData, vectors: np.ndarray) -> float | None:
    """Of the first time at which there is a field."""
    moving = next((sample for sample in vectors if np.any(sample)), vectors[0])
    return tangent_share(mesh.vertices, mesh.triangles, moving)


def _changes(parts: Sequence[RawSurface], welded: Welded) -> dict[str, int]:
    total: dict[str, int] = {}
    for part in parts:
        for what, count in part.changes.items():
            total[what] = total.get(what, 0) + count
    for what, count in welded.changes().items():
        total[what] = total.get(what, 0) + count
    return total


@dataclass(frozen=True, eq=False)
class Clock:
    """λ of the samples, their times where there are any, and what has to be said of them."""

    lambdas: np.ndarray
    times: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()


def _time(step: SurfaceTime, parts: Sequence[RawSurface]) -> float | None:
    return step.time if step.time is not None else next((p.time for p in parts if p.time is not None), None)


def _clock(data: SurfaceTimes, times: Sequence[float | None]) -> Clock:
    """Times as they are known, else the numbers in names of files, else nothing but an order."""
    known = [time for time in times if time is not None]
    if len(known) == len(times):
        return Clock(lambdas_of(np.array(known), data.name), tuple(known))
    if len(times) == 1:
        return Clock(np.zeros(1))
    numbers = [step.number for step in data.times if step.number is not None]
    if len(numbers) == len(times):
        note = "the files have no times, the numbers in their names stand for them"
        return Clock(lambdas_of(np.array(numbers), data.name), (), (note,))
    return Clock(np.linspace(0.0, 1.0, len(times)), (), ("the data have no times, λ is even",))


def _unit(taken: Taken) -> str:
    units = {array.unit for array in taken.arrays}
    return units.pop() if len(units) == 1 else ""


def _files(data: SurfaceTimes) -> tuple[str, ...]:
    return tuple(dict.fromkeys(str(file) for step in data.times for file in step.files))


def _named(files: Sequence[Path]) -> str:
    return ", ".join(map(str, files[:3])) + (", …" if len(files) > 3 else "")
