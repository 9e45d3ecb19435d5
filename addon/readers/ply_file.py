# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY: vertices and faces with all numbers that they carry, among whatever other elements there are, in any order.

ply = read_ply(Path("wall.ply"))      # ply.points (n, 3), ply.polygons, ply.point_data["vx"] (n, 1)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..model.errors import InputError

TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"},
    **{"int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8"},
}
CORNERS = ("vertex_indices", "vertex_index")
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True, eq=False)
class Ply:
    """polygons: each the numbers of its corners; data by name, (n, k), of points and of faces."""

    points: np.ndarray
    polygons: list[np.ndarray]
    point_data: dict[str, np.ndarray]
    face_data: dict[str, np.ndarray]


@dataclass(frozen=True)
class _Property:
    """count: the type of the length of a list; None for one number."""

    name: str
    kind: str
    count: str | None = None


@dataclass
class _Element:
    name: str
    size: int
    properties: list[_Property] = field(default_factory=list)


def read_ply(path: Path) -> Ply:
    """Raises InputError that names the file and what is wrong."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    try:
        elements, order, begin = _header(content)
        rows = _ascii(content[begin:], elements) if not order else _binary(content, begin, elements, order)
    except (ValueError, KeyError, IndexError, StopIteration, UnicodeDecodeError) as error:
        reason = str(error) or "it ends early"
        raise InputError(f"{path}: is not a mesh that can be read ({reason}); write it again") from error
    return _ply(path, rows)


def _header(content: bytes) -> tuple[list[_Element], str, int]:
    """The elements, the order of bytes, empty for text, and where the rows begin."""
    lines = content.splitlines(keepends=True)
    if not lines or lines[0].strip() != b"ply":
        raise ValueError("it does not begin with ply")
    elements: list[_Element] = []
    order, begin = None, 0
    for line in lines:
        begin += len(line)
        words = line.decode("ascii").split()
        if words[:1] == ["format"]:
            order = ORDERS[words[1]]
        elif words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2])))
        elif words[:2] == ["property", "list"]:
            elements[-1].properties.append(_Property(words[4], TYPES[words[3]], TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1].properties.append(_Property(words[2], TYPES[words[1]]))
        elif words == ["end_header"]:
            break
    if order is None:
        raise ValueError("it has no line that begins with format")
    return elements, order, begin


#: Of each element its columns: (n,) numbers, or one array for each row.
Rows = dict[str, dict[str, "np.ndarray | list[np.ndarray]"]]


def _ascii(content: bytes, elements: list[_Element]) -> Rows:
    numbers = np.array(content.split(), np.float64)
    found, at = {}, 0
    for element in elements:
        found[element.name], at = _columns(numbers, at, element)
    return found


def _columns(numbers: np.ndarray, at: int, element: _Element) -> tuple[dict, int]:
    """The columns of an element whose rows begin at a place of a row of numbers, and where they end."""
    width = len(element.properties)
    if all(one.count is None for one in element.properties):
        end = at + width * element.size
        table = numbers[at:end].reshape(element.size, width)
        return {one.name: table[:, k].astype(one.kind) for k, one in enumerate(element.properties)}, end
    columns: dict = {one.name: [] for one in element.properties}
    for _ in range(element.size):
        for one in element.properties:
            length = 1 if one.count is None else int(numbers[at])
            at += one.count is not None
            values = numbers[at : at + length].astype(one.kind)
            if len(values) < length:
                raise ValueError(f"element {element.name} ends early")
            columns[one.name].append(values)
            at += length
    return {one.name: _packed(columns[one.name], one) for one in element.properties}, at


def _packed(rows: list[np.ndarray], one: _Property):
    return rows if one.count is not None else np.concatenate([*rows, np.zeros(0, one.kind)])


def _binary(content: bytes, begin: int, elements: list[_Element], order: str) -> Rows:
    found, at = {}, begin
    for element in elements:
        lengths = _lengths(content, at, element, order)
        kind = np.dtype([field for one in element.properties for field in _fields(one, lengths, order)])
        end = at + kind.itemsize * element.size
        table = np.frombuffer(content, kind, element.size, at) if end <= len(content) else None
        if table is not None and all((table[f"#{name}"] == length).all() for name, length in lengths.items()):
            found[element.name] = {
                one.name: table[one.name] if one.count is None else list(table[one.name]) for one in element.properties
            }
            at = end
        else:
            found[element.name], at = _uneven(content, at, element, order)
    return found


def _lengths(content: bytes, at: int, element: _Element, order: str) -> dict[str, int]:
    """The lengths of the lists in the first row, which most files have in all."""
    lengths = {}
    for one in element.properties if element.size else ():
        if one.count is not None:
            count = np.frombuffer(content, order + one.count, 1, at)
            lengths[one.name] = int(count[0])
            at += count.itemsize
        at += np.dtype(one.kind).itemsize * lengths.get(one.name, 1)
    return lengths


def _fields(one: _Property, lengths: dict[str, int], order: str) -> list[tuple]:
    if one.count is None:
        return [(one.name, order + one.kind)]
    return [(f"#{one.name}", order + one.count), (one.name, order + one.kind, (lengths.get(one.name, 0),))]


def _uneven(content: bytes, at: int, element: _Element, order: str) -> tuple[dict, int]:
    """Rows whose lists differ in length, one after another."""
    columns: dict = {one.name: [] for one in element.properties}
    for _ in range(element.size):
        for one in element.properties:
            length = 1
            if one.count is not None:
                count = np.frombuffer(content, order + one.count, 1, at)
                length, at = int(count[0]), at + count.itemsize
            values = np.frombuffer(content, order + one.kind, length, at)
            columns[one.name].append(values)
            at += values.nbytes
    return {one.name: _packed(columns[one.name], one) for one in element.properties}, at


def _ply(path: Path, rows: Rows) -> Ply:
    vertices, faces = rows.get("vertex", {}), rows.get("face", {})
    if not all(name in vertices for name in "xyz") or not len(vertices["x"]):
        raise InputError(f"{path}: has no vertices; give a surface of triangles")
    corners = next((faces[name] for name in CORNERS if name in faces), None)
    if corners is None or not len(corners):
        raise InputError(f"{path}: has no faces; give a surface of triangles")
    points = np.column_stack([np.asarray(vertices[name], np.float64) for name in "xyz"])
    polygons = [np.asarray(row, np.int64) for row in corners]
    wrong = next((k for k, row in enumerate(polygons) if len(row) < 3), None)
    if wrong is not None:
        raise InputError(f"{path}: face {wrong} has {len(polygons[wrong])} corners; give at least three")
    everything = np.concatenate(polygons)
    if everything.min() < 0 or everything.max() >= len(points):
        raise InputError(
            f"{path}: has a face that names vertex {everything.max()}, but there are {len(points)}; write it again"
        )
    return Ply(points, polygons, _data(vertices, "xyz"), _data(faces, CORNERS))


def _data(columns: dict, without) -> dict[str, np.ndarray]:
    """Numbers, and lists that are equally long in all rows, as (n, k)."""
    found = {}
    for name, values in columns.items():
        if name in without:
            continue
        if isinstance(values, list):
            if not values or len({len(row) for row in values}) > 1 or not len(values[0]):
                continue
            values = np.stack(values)
        found[name] = np.asarray(values).reshape(len(values), -1)
    return {name: values.astype(values.dtype.newbyteorder("=")) for name, values in found.items()}
