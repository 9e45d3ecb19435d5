# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields in a file of their own beside a mesh of the same name: .rawfield, .ffield, .dmat, .txt, .csv

.rawfield  "N faces", then a row of N vectors per face (Directional)
.ffield    two rows of words, the number of faces, a row of names, then lengths and vectors of two directions per face
.dmat      "columns rows", then the numbers column by column (libigl)
.txt .csv  a row of three numbers per face or per vertex
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..model.errors import InputError

ENDINGS = (".rawfield", ".ffield", ".dmat", ".txt", ".csv")
#: Meshes that a field may lie beside, the first that is there counts.
MESHES = (".off", ".obj")


def mesh_beside(path: Path) -> Path:
    """The mesh that a file of vectors belongs to. Raises InputError where there is none."""
    found = [path.with_suffix(ending) for ending in MESHES if path.with_suffix(ending).exists()]
    if not found:
        names = ", ".join(path.with_suffix(ending).name for ending in MESHES)
        raise InputError(f"{path}: is a field without a mesh; put {names} of the same name beside it")
    return found[0]


def fields_beside(path: Path) -> list[Path]:
    """The files of vectors that belong to a mesh."""
    return [path.with_suffix(ending) for ending in ENDINGS if path.with_suffix(ending).exists()]


def read_vectors(path: Path) -> dict[str, np.ndarray]:
    """Vectors by name, (rows, 3). Raises InputError."""
    try:
        return _READERS[path.suffix.lower()](path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, IndexError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: is not a file of vectors ({error}); give three numbers per face or vertex"
        ) from error


def _rawfield(path: Path) -> dict[str, np.ndarray]:
    words = path.read_text(encoding="ascii").split()
    degree, faces = int(words[0]), int(words[1])
    if degree != 1:
        raise InputError(
            f"{path}: has {degree} directions per face, none of which is the first; give one vector per face"
        )
    return {path.name: np.array(words[2:], np.float64).reshape(faces, 3)}


def _ffield(path: Path) -> dict[str, np.ndarray]:
    lines = [line for line in path.read_text(encoding="ascii").splitlines() if line.strip()]
    start = next(k for k, line in enumerate(lines) if line.split()[0].lower() == "k1")
    rows = np.array([line.split() for line in lines[start + 1 :]], np.float64)
    if rows.shape[1] != 8 or len(rows) != int(lines[start - 1]):
        raise InputError(f"{path}: has {rows.shape} numbers; give {lines[start - 1]} rows of 8")
    return {f"{path.name} k{k + 1}": rows[:, [k]] * rows[:, 2 + 3 * k : 5 + 3 * k] for k in (0, 1)}


def _dmat(path: Path) -> dict[str, np.ndarray]:
    head, _, rest = path.read_bytes().partition(b"\n")
    columns, rows = map(int, head.split()[:2])
    if (columns, rows) == (0, 0):  # binary: the numbers of columns and rows follow once more
        head, _, rest = rest.partition(b"\n")
        columns, rows = map(int, head.split()[:2])
        numbers = np.frombuffer(rest, "<f8", columns * rows)
    else:
        numbers = np.array(rest.split(), np.float64)
    return {path.name: _three(path, numbers.reshape(columns, rows).T)}


def _text(path: Path) -> dict[str, np.ndarray]:
    lines = [line.split("#", 1)[0].replace(",", " ").replace(";", " ").split() for line in _readable(path)]
    rows = [line for line in lines if line]
    if rows and not _is_number(rows[0][0]):  # the names of columns
        rows = rows[1:]
    return {path.name: _three(path, np.array(rows, np.float64))}


def _readable(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines()


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _three(path: Path, rows: np.ndarray) -> np.ndarray:
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InputError(f"{path}: has rows of {rows.shape[-1]} numbers; give three per face or vertex")
    return rows


_READERS = {".rawfield": _rawfield, ".ffield": _ffield, ".dmat": _dmat, ".txt": _text, ".csv": _text}
