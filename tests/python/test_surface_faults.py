# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and files that cannot be used are refused in one line."""

import json
import subprocess
import sys

import numpy as np
import pytest
from command_line import refused, run
from stormfield.readers.surface_vector import marked
from surface_answers import (
    CENTRES,
    POINTS,
    TRIANGLES,
    WSS,
    analysis,
    assert_right,
    ball_of_tetrahedra,
    changes,
    kinds,
    scalars,
    write_off,
)
from surface_cases import (
    KINDS,
    flow,
    poly_data,
    write_mesh,
    write_vtk,
    write_xdmf,
)  # fmt: skip


@pytest.mark.parametrize(
    ("size", "speed", "offset"), [(1e-9, 1e-12, 0), (6.371e9, 1e9, 0), (1.0, 1.0, 5e5), (1e20, 1e-20, 0)]
)
def test_any_scale(capsys, tmp_path, size, speed, offset):
    path = write_mesh(tmp_path / "a.vtu", size * POINTS + offset, TRIANGLES, point_data={"U": speed * WSS})
    content = analysis(capsys, path)
    assert kinds(content) == KINDS and content["index_sum"] == 2


@pytest.mark.parametrize(
    ("points", "field", "words"),
    [
        (POINTS, 1e200 * WSS, "cannot be computed with"),
        (POINTS, 1e-300 * WSS, "cannot be computed with"),
        (1e200 * POINTS, WSS, "cannot be computed with"),
        (POINTS, 0 * WSS, "zero everywhere"),
        (POINTS, np.nan * WSS, "of point 0 is not finite (642 of 642"),
        (POINTS, np.where(np.arange(642)[:, None] == 100, np.inf, WSS), "of point 100 is not finite (1 of 642"),
    ],
)
def test_numbers_that_cannot_be_computed_with_are_refused(capsys, tmp_path, points, field, words):
    path = write_mesh(tmp_path / "a.vtu", points, TRIANGLES, point_data={"U": field})
    line = refused(capsys, "analyze", path, "--json", "-")
    assert words in line and str(path) in line


def test_a_place_that_is_not_finite_is_refused_where_a_face_uses_it(capsys, tmp_path):
    points = np.concatenate([POINTS, [[np.nan, 0, 0]]])
    field = np.concatenate([WSS, [[0.0, 0, 0]]])
    assert_right(analysis(capsys, write_mesh(tmp_path / "unused.vtu", points, TRIANGLES, point_data={"U": field})))
    points[7] = np.inf
    path = write_mesh(tmp_path / "used.vtu", points, TRIANGLES, point_data={"U": field})
    assert "used.vtu: point 7 has no finite position" in refused(capsys, "analyze", path, "--json", "-")


def test_every_defect_of_a_mesh_names_the_file(capsys, tmp_path):
    fin = np.concatenate([TRIANGLES, [[TRIANGLES[0][0], TRIANGLES[0][1], 300]]])
    path = write_mesh(tmp_path / "fin.vtu", POINTS, fin, point_data={"U": WSS})
    assert str(path) in refused(capsys, "analyze", path, "--json", "-")
    assert str(path) in refused(capsys, "info", path)


def test_turned_faces_are_said(capsys, tmp_path):
    faces = TRIANGLES.copy()
    faces[5:8] = faces[5:8, ::-1]
    content = analysis(capsys, write_mesh(tmp_path / "turned.vtu", POINTS, faces, point_data={"U": WSS}))
    assert_right(content)
    assert changes(content) == {"faces turned as their neighbours are": 3}


@pytest.mark.parametrize("ending", ["vtp", "vtu", "vtk", "ply", "off", "obj", "stl", "xdmf"])
def test_half_a_file_is_refused_in_one_line(capsys, tmp_path, ending):
    path = tmp_path / f"wall.{ending}"
    if ending == "off":
        write_off(path)
    elif ending == "xdmf":
        write_xdmf(path, POINTS, TRIANGLES, [(0.0, WSS)])
    elif ending in ("vtp", "vtk", "stl"):
        write_vtk(path, poly_data(POINTS, TRIANGLES, {"WSS": WSS}))
    else:
        data = {"obj": {}, "ply": scalars("abc", WSS)}.get(ending, {"WSS": WSS})
        write_mesh(path, POINTS, TRIANGLES, point_data=data)
    whole = path.read_bytes()
    for part in (0.0, 0.3, 0.6, 0.97):
        path.write_bytes(whole[: int(part * len(whole))])
        status, out, err = run(capsys, "analyze", path, "--json", "-")
        assert status == 2 and out == "" and err.count("\n") == 1 and path.name in err, (part, err)


def test_without_vtk_the_message_says_what_to_install(capsys, tmp_path, monkeypatch):
    plain = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data={"U": WSS})
    path = write_vtk(tmp_path / "a.vtp", poly_data(POINTS, TRIANGLES, {"U": WSS}))
    volume = write_mesh(tmp_path / "v.vtu", *ball_of_tetrahedra(), "tetra")
    for name in [name for name in sys.modules if name.startswith("vtkmodules")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "vtkmodules", None)
    assert "pip install vtk" in refused(capsys, "analyze", path, "--json", "-")
    assert "pip install vtk" in refused(capsys, "analyze", volume, "--json", "-")
    assert_right(analysis(capsys, plain))


@pytest.mark.parametrize("first", ["bpy", "vtkmodules.vtkIOXML"])
def test_vtk_and_blender_share_a_process(tmp_path, first):
    """Whichever is loaded first, the answer is the same."""
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data={"U": WSS})
    code = (
        f"import sys, contextlib\nwith contextlib.suppress(ImportError):\n import {first}\n"
        f"from stormfield.cli import main\nfrom stormfield.cli.blender import leave\n"
        f"leave(main(['analyze', {str(path)!r}, '--json', {str(tmp_path / 'a.json')!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert_right(json.loads((tmp_path / "a.json").read_text()))


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (("--level", "850"), "nothing to choose by --level"),
        (("--member", "3"), "nothing to choose by --member"),
        (("--times", "0", "1"), "nothing to choose by --times"),
        (("--at", "depth=5"), "nothing to choose by --at depth"),
    ],
)
def test_what_only_a_grid_has_is_not_left_aside_in_silence(capsys, tmp_path, option, words):
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data={"U": WSS})
    assert words in refused(capsys, "analyze", path, *option, "--json", "-")


def test_an_array_that_a_t_file_does_not_have_is_refused(capsys, tmp_path):
    rows = [f"{len(TRIANGLES)} {len(POINTS)}", *(" ".join(map(str, row)) for row in (*TRIANGLES, *POINTS, *WSS))]
    (tmp_path / "a.t").write_text("\n".join(rows))
    assert kinds(analysis(capsys, tmp_path / "a.t")) == KINDS
    assert "has no array 'WSS'" in refused(capsys, "analyze", tmp_path / "a.t", "--vector", "WSS", "--json", "-")


@pytest.mark.parametrize("mark", [-9999.0, 1e20, 32767.0])
@pytest.mark.parametrize("location", ["point_data", "cell_data"])
def test_marks_of_no_value_are_refused(capsys, tmp_path, mark, location):
    vectors = np.array(WSS if location == "point_data" else flow(CENTRES))
    vectors[3:9] = mark
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, **{location: {"WSS": vectors}})
    line = refused(capsys, "analyze", path, "--json", "-")
    assert f"6 of {len(vectors)} vectors" in line and f"{mark:g} in every component" in line


def test_one_large_vector_is_no_mark():
    """Of equal components by chance, or so near the others that it may be true."""
    assert not marked(np.array([[1.0, 2.0, 3.0], [999.0, 999.0, 999.0]])).any()
    assert not marked(np.array([[400.0, 2.0, 3.0], [999.0, 999.0, 999.0], [999.0, 999.0, 999.0]])).any()
    assert marked(np.array([[4.0, 2.0, 3.0], [999.0, 999.0, 999.0], [999.0, 999.0, 999.0]])).sum() == 2
