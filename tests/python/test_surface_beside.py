# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields in files beside a mesh."""

import json

import numpy as np
import pytest
from command_line import refused, run
from surface_answers import CENTRES, POINTS, TRIANGLES, WSS, analysis, assert_right, write_off
from surface_cases import (
    flow,
    poly_data,
    write_vtk,
)  # fmt: skip


def rows_of(vectors):
    return "\n".join(" ".join(map(repr, row)) for row in np.asarray(vectors).tolist()) + "\n"


BESIDE = {
    "rawfield": lambda v: f"1 {len(v)}\n{rows_of(v)}",
    "dmat": lambda v: f"3 {len(v)}\n{rows_of(v.T)}",
    "txt": rows_of,
    "csv": lambda v: "x,y,z\n" + rows_of(v).replace(" ", ","),
}


@pytest.mark.parametrize("where", ["faces", "vertices"])
@pytest.mark.parametrize("ending", BESIDE)
def test_fields_in_files_beside_an_off(capsys, tmp_path, ending, where):
    mesh = write_off(tmp_path / "m.off")
    field = tmp_path / f"m.{ending}"
    field.write_text(BESIDE[ending](flow(CENTRES) if where == "faces" else WSS))
    for given in (mesh, field):
        status, out, _ = run(capsys, "analyze", given, "--json", "-")
        assert status == 0
        content = json.loads(out)
        assert_right(content)
        assert content["read"]["arrays"][0]["name"] == field.name
        assert content["read"]["arrays"][0]["location"] == ("cells" if where == "faces" else "points")


def test_binary_dmat_frames_and_an_obj(capsys, tmp_path):
    faces = flow(CENTRES)
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in POINTS.tolist()] + [
        "f " + " ".join(str(v + 1) for v in row) for row in TRIANGLES
    ]
    (tmp_path / "m.obj").write_text("\n".join(rows))
    (tmp_path / "m.dmat").write_bytes(b"0 0\n" + f"3 {len(faces)}\n".encode() + faces.T.astype("<f8").tobytes())
    assert_right(analysis(capsys, tmp_path / "m.obj"))
    (tmp_path / "m.dmat").unlink()
    lengths = np.linalg.norm(faces, axis=1, keepdims=True)
    table = np.column_stack([lengths, lengths, faces / lengths, np.cross(CENTRES, faces / lengths)])
    names = "k1 k2 k1v_x k1v_y k1v_z k2v_x k2v_y k2v_z"
    (tmp_path / "m.ffield").write_text(f"# frame\ntarget frame\n{len(faces)}\n{names}\n{rows_of(table)}")
    assert "which array" in refused(capsys, "analyze", tmp_path / "m.obj", "--json", "-")
    assert_right(analysis(capsys, tmp_path / "m.obj", "--vector", "m.ffield k1"))


@pytest.mark.parametrize(
    ("ending", "text", "words"),
    [
        ("rawfield", f"4 2\n{rows_of(np.ones((2, 12)))}", "4 directions per face"),
        ("rawfield", f"1 7\n{rows_of(np.ones((7, 3)))}", "7 vectors, but m.off has 1280 faces and 642 vertices"),
        ("rawfield", f"1 1280\n{rows_of(np.ones((7, 3)))}", "is not a file of vectors"),
        ("txt", rows_of(np.ones((1280, 2))), "rows of 2 numbers"),
        ("txt", "one two three\nfour five six\n", "is not a file of vectors"),
        ("dmat", "\n", "is not a file of vectors"),
    ],
)
def test_bad_fields_beside_a_mesh_are_refused(capsys, tmp_path, ending, text, words):
    write_off(tmp_path / "m.off")
    (tmp_path / f"m.{ending}").write_text(text)
    line = refused(capsys, "analyze", tmp_path / "m.off", "--json", "-")
    assert words in line and f"m.{ending}" in line


def test_meshes_without_a_field_say_so(capsys, tmp_path):
    assert "a mesh without data" in refused(capsys, "analyze", write_off(tmp_path / "m.off"), "--json", "-")
    assert run(capsys, "info", tmp_path / "m.off")[0] == 0
    (tmp_path / "alone.rawfield").write_text("1 1\n1 0 0\n")
    assert "put alone.off" in refused(capsys, "analyze", tmp_path / "alone.rawfield", "--json", "-")
    path = write_vtk(tmp_path / "m.stl", poly_data(POINTS, TRIANGLES))
    assert "a mesh without data" in refused(capsys, "analyze", path, "--json", "-")
    assert json.loads(run(capsys, "info", path)[1])["mesh"]["euler_characteristic"] == 2
