# SPDX-License-Identifier: GPL-3.0-or-later
"""OFF and OBJ: polygons in the order of the file, which fields in files beside them go by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..model.errors import InputError


@dataclass(frozen=True, eq=False)
class Polygons:
    """points (n, 3); polygons, each the numbers of its corners; point_data by name, (n, k)."""

    points: np.ndarray
    polygons: list[np.ndarray]
    point_data: dict[str, np.ndarray] = field(default_factory=dict)


def read_off(path: Path) -> Polygons:
    """OFF, also with colours (COFF) and normals (NOFF). Raises InputError."""
    lines = _lines(path)
    head = next(lines, "")
    if not head.split()[:1] or not head.split()[0].upper().endswith("OFF"):
        raise InputError(f"{path}: does not begin with OFF")
    with_normals = "N" in head.split()[0].upper().removesuffix("OFF")
    counts = head.split()[1:] or next(lines, "").split()
    try:
        vertices, faces = int(counts[0]), int(counts[1])
        rows = [np.array(next(lines).split(), np.float64) for _ in range(vertices)]
        corners = [next(lines).split() for _ in range(faces)]
        polygons = [np.array(row[1 : 1 + int(row[0])], np.int64) for row in corners]
        points = np.array([row[:3] for row in rows], np.float64).reshape(-1, 3)
    except (StopIteration, IndexError, ValueError) as error:
        raise InputError(f"{path}: ends early or has a word where a number should be; write it again") from error
    data = {"normals": np.array([row[3:6] for row in rows])} if with_normals else {}
    return _checked(path, Polygons(points, polygons, data))


def read_obj(path: Path) -> Polygons:
    """Positions, faces and, where each vertex has one, the normals of Wavefront OBJ. Raises InputError."""
    points: list[list[str]] = []
    normals: list[list[str]] = []
    polygons: list[np.ndarray] = []
    normal_of: dict[int, int] = {}
    try:
        for line in _lines(path):
            words = line.split()
            if words[0] == "v":
                points.append(words[1:4])
            elif words[0] == "vn":
                normals.append(words[1:4])
            elif words[0] == "f":
                corners = [word.split("/") for word in words[1:]]
                polygon = [_from_zero(corner[0], len(points)) for corner in corners]
                polygons.append(np.array(polygon, np.int64))
                for vertex, corner in zip(polygon, corners, strict=True):
                    if len(corner) == 3 and corner[2]:
                        number = _from_zero(corner[2], len(normals))
                        normal_of[vertex] = number if normal_of.get(vertex, number) == number else -1
        places = np.array(points, np.float64).reshape(-1, 3)
        across = np.array(normals, np.float64).reshape(-1, 3)
    except (ValueError, IndexError) as error:
        raise InputError(f"{path}: is not an OBJ file ({error})") from error
    numbers = np.array([normal_of.get(vertex, -1) for vertex in range(len(places))], np.int64)
    whole = len(across) and (numbers >= 0).all() and numbers.max(initial=-1) < len(across)
    return _checked(path, Polygons(places, polygons, {"vn": across[numbers]} if whole else {}))


def _from_zero(word: str, count: int) -> int:
    """OBJ counts from 1, and backwards from −1."""
    number = int(word)
    return number - 1 if number > 0 else count + number


def _lines(path: Path) -> Iterator[str]:
    """Lines without comments; a backslash joins two."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return (line for line in (line.split("#", 1)[0].strip() for line in text.splitlines()) if line)


def _checked(path: Path, found: Polygons) -> Polygons:
    if not len(found.points) or not found.polygons:
        raise InputError(f"{path}: has no faces; give a surface of triangles")
    corners = np.concatenate(found.polygons)
    if corners.min() < 0 or corners.max() >= len(found.points):
        raise InputError(f"{path}: a face has vertex {corners.max()}, but there are {len(found.points)}")
    if min(map(len, found.polygons)) < 3:
        raise InputError(f"{path}: a face has fewer than 3 vertices")
    return found
