# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals are never taken for the field."""

import json

import numpy as np
from command_line import refused, run
from surface_answers import CENTRES, NORMALS, POINTS, TRIANGLES, WSS, analysis, assert_right, scalars
from surface_cases import (
    ball,
    write_mesh,
)  # fmt: skip


def test_normals_are_never_the_field(capsys, tmp_path):
    alone = write_mesh(tmp_path / "n.ply", POINTS, TRIANGLES, point_data=scalars(("nx", "ny", "nz"), NORMALS))
    line = refused(capsys, "analyze", alone, "--json", "-")
    assert str(alone) in line and "normals are no field" in line and "no other array" in line
    assert run(capsys, "info", alone)[0] == 0
    data = scalars(("nx", "ny", "nz"), NORMALS) | scalars(("vx", "vy", "vz"), WSS)
    both = write_mesh(tmp_path / "both.ply", POINTS, TRIANGLES, point_data=data)
    content = analysis(capsys, both)
    assert_right(content)
    assert [array["name"] for array in content["read"]["arrays"]] == ["vx", "vy", "vz"]
    assert "the other vectors are normals" in content["read"]["notes"][0]
    named = refused(capsys, "analyze", both, "--vector", "nx,ny,nz", "--json", "-")
    assert "choose with --vector from: vx" in named


def test_names_of_normals_may_hold_a_field_as_in_the_data_of_the_thesis(capsys, tmp_path):
    assert_right(
        analysis(capsys, write_mesh(tmp_path / "t.ply", POINTS, TRIANGLES, point_data=scalars(("nx", "ny", "nz"), WSS)))
    )


def test_normals_of_a_coarse_mesh_of_long_and_of_inward_normals(capsys, tmp_path):
    points, triangles = ball(80)
    rough = points * (1 + 0.1 * np.sin(7 * points[:, [0]]))
    for name, normals in (("unit", points), ("long", 5 * points), ("inward", -points)):
        path = write_mesh(
            tmp_path / f"{name}.vtu", rough if name == "unit" else points, triangles, point_data={"data": normals}
        )
        assert "normals are no field" in refused(capsys, "analyze", path, "--json", "-")


def test_normals_of_an_obj(capsys, tmp_path):
    rows = [f"v {x} {y} {z}" for x, y, z in POINTS] + [f"vn {x} {y} {z}" for x, y, z in NORMALS]
    rows += ["f " + " ".join(f"{v + 1}//{v + 1}" for v in row) for row in TRIANGLES]
    path = tmp_path / "n.obj"
    path.write_text("\n".join(rows))
    assert "vn (points, 3 components) is normal" in refused(capsys, "analyze", path, "--json", "-")
    status, out, err = run(capsys, "info", path)
    assert status == 0 and json.loads(out)["read"]["choices"][0]["name"] == "vn" and "mesh alone" in err


def test_normals_of_cells_and_of_split_points(capsys, tmp_path):
    split = POINTS[TRIANGLES].reshape(-1, 3)
    each = np.arange(len(split)).reshape(-1, 3)
    path = write_mesh(tmp_path / "s.vtu", split, each, point_data={"data": 2 * split})
    assert "normals are no field" in refused(capsys, "analyze", path, "--json", "-")
    path = write_mesh(tmp_path / "c.vtu", POINTS, TRIANGLES, cell_data={"data": CENTRES})
    assert "normals are no field" in refused(capsys, "analyze", path, "--json", "-")
