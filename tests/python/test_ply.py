# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY with elements and properties of any kind and order, as text and binary."""

import numpy as np
import pytest
from stormfield.model.errors import InputError
from stormfield.readers import read_field
from stormfield.readers.ply_file import TYPES, read_ply
from surface_cases import ball, flow

POINTS, TRIANGLES = ball()
FLOW = flow(POINTS)

VERTEX = [("x", "float"), ("y", "float"), ("z", "float"), ("vx", "float"), ("vy", "double"), ("vz", "float")]
CAMERA = ("camera", [("px", "float"), ("list", "uchar", "short", "ids")], [[0.5, [1, 2]], [1.5, [3]]])


def face(more=(), values=()):
    return ("face", [("list", "uchar", "int", "vertex_index"), *more], [[list(row), *values] for row in TRIANGLES])


VERTICES = ("vertex", VERTEX, np.column_stack([POINTS, FLOW]).tolist())


def ply(elements, order):
    """The file of (name, properties, rows); order: ascii, little or big."""
    words = {"ascii": "ascii", "little": "binary_little_endian", "big": "binary_big_endian"}[order]
    lines = ["ply", f"format {words} 1.0", "comment by hand"]
    for name, properties, rows in elements:
        lines.append(f"element {name} {len(rows)}")
        lines += [
            f"property list {one[1]} {one[2]} {one[3]}" if one[0] == "list" else f"property {one[1]} {one[0]}"
            for one in properties
        ]
    body = [_value(value, one, order) for _, properties, rows in elements for row in rows
            for value, one in zip(row, properties, strict=True)]  # fmt: skip
    return "\n".join([*lines, "end_header", ""]).encode() + b"".join(body)


def _value(value, one, order):
    values = value if one[0] == "list" else [value]
    kinds = [one[1]] + [one[2]] * len(values) if one[0] == "list" else [one[1]]
    numbers = [len(values), *values] if one[0] == "list" else values
    if order == "ascii":
        return (" ".join(f"{number:.9g}" for number in numbers) + "\n").encode()
    mark = {"little": "<", "big": ">"}[order]
    return b"".join(np.array(n, mark + TYPES[kind]).tobytes() for n, kind in zip(numbers, kinds, strict=True))


@pytest.mark.parametrize("order", ["ascii", "little", "big"])
@pytest.mark.parametrize(
    "elements",
    [
        [VERTICES, face()],
        [face(), VERTICES],
        [CAMERA, VERTICES, ("edge", [("vertex1", "int")], [[0], [1]]), face(), ("material", [("a", "int")], [])],
        [VERTICES, face([("flag", "uchar"), ("list", "uchar", "float", "texcoord")], [7, [0, 0, 0, 1, 1, 1]])],
    ],
    ids=["plain", "faces first", "many elements", "more of faces"],
)
def test_the_field_is_read_whatever_stands_beside_it(tmp_path, elements, order):
    (tmp_path / "a.ply").write_bytes(ply(elements, order))
    data = read_field(tmp_path / "a.ply")
    assert np.allclose(data.mesh.vertices, POINTS, atol=1e-6) and np.array_equal(data.mesh.triangles, TRIANGLES)
    assert np.allclose(data.vectors[0], FLOW, atol=1e-6)


def test_a_list_of_three_is_a_vector(tmp_path):
    rows = [[*place, list(vector)] for place, vector in zip(POINTS.tolist(), FLOW.tolist(), strict=True)]
    (tmp_path / "a.ply").write_bytes(
        ply([("vertex", [*VERTEX[:3], ("list", "uchar", "float", "flow")], rows), face()], "big")
    )
    data = read_field(tmp_path / "a.ply")
    assert data.read.arrays[0].name == "flow" and np.allclose(data.vectors[0], FLOW, atol=1e-6)


def test_faces_of_different_corners(tmp_path):
    corners = ("vertex", VERTEX[:3], [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    faces = ("face", [("list", "uchar", "int", "vertex_indices")], [[[0, 1, 2, 3]], [[1, 4, 2]]])
    for order in ("ascii", "little"):
        (tmp_path / "a.ply").write_bytes(ply([corners, faces], order))
        assert [row.tolist() for row in read_ply(tmp_path / "a.ply").polygons] == [[0, 1, 2, 3], [1, 4, 2]]


def wrong(corners):
    return ply([VERTICES, ("face", [("list", "uchar", "int", "vertex_index")], [[corners]])], "ascii")


WHOLE = ply([VERTICES, face()], "little")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "does not begin with ply"),
        (b"solid", "does not begin with ply"),
        (WHOLE[: len(WHOLE) // 2], "is not a mesh that can be read"),
        (ply([VERTICES, face()], "ascii")[:-20], "is not a mesh that can be read"),
        (WHOLE.replace(b"property double vy", b"property dubble vy"), "is not a mesh that can be read"),
        (ply([VERTICES], "ascii"), "has no faces"),
        (ply([("vertex", VERTEX, []), face()], "ascii"), "has no vertices"),
        (wrong([0, 1, 99999]), "vertex 99999"),
        (wrong([0, 1]), "2 corners"),
    ],
)  # fmt: skip
def test_broken_files_are_refused(tmp_path, content, words):
    (tmp_path / "a.ply").write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_field(tmp_path / "a.ply")
