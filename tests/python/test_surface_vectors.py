# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as other programs write them: formats, and which array is the field."""

import numpy as np
import pytest
from command_line import refused, run
from surface_answers import CENTRES, NORMALS, POINTS, TRIANGLES, WSS, analysis, assert_right, changes, kinds
from surface_cases import (
    KINDS,
    cells_of,
    flow,
    grid,
    grid_quads,
    poly_data,
    with_data,
    write_mesh,
    write_vtk,
)  # fmt: skip
from vtkmodules.vtkCommonDataModel import vtkPolyData


@pytest.mark.parametrize("ending", ["vtp", "vtk"])
def test_polygon_data_of_vtk(capsys, tmp_path, ending):
    data = poly_data(POINTS, TRIANGLES, {"WSS": WSS, "pressure": POINTS[:, 0]})
    content = analysis(capsys, write_vtk(tmp_path / f"wall.{ending}", data))
    assert_right(content)
    assert content["read"]["arrays"] == [{"name": "WSS", "location": "points", "components": 3, "unit": ""}]
    assert content["mesh"]["vertices"] == len(POINTS) and content["read"]["tangent_share"] > 0.99


def test_legacy_files_with_normals_and_fields(capsys, tmp_path):
    data = poly_data(POINTS, TRIANGLES, {"U": WSS, "WSS": 2 * WSS})
    data.GetPointData().SetNormals(with_data(vtkPolyData(), POINTS, {"Normals": NORMALS}).GetPointData().GetArray(0))
    path = write_vtk(tmp_path / "wall.vtk", data)
    assert_right(analysis(capsys, path, "--vector", "WSS"))
    assert "which array is the field?" in refused(capsys, "analyze", path, "--json", "-")


@pytest.mark.parametrize("ending", ["vtu", "ply", "msh"])
def test_what_meshio_writes(capsys, tmp_path, ending):
    path = tmp_path / f"wall.{ending}"
    options = {"file_format": "gmsh22"} if ending == "msh" else {}
    data = {"w_x": WSS[:, 0], "w_y": WSS[:, 1], "w_z": WSS[:, 2]} if ending == "ply" else {"WSS": WSS}
    assert_right(analysis(capsys, write_mesh(path, POINTS, TRIANGLES.astype(np.int32), point_data=data, **options)))


def vessel():
    """A pipe with a bulge, open at both ends."""
    rows, around = 61, 48
    z, turn = np.meshgrid(np.linspace(-3, 3, rows), np.arange(around) * 2 * np.pi / around, indexing="ij")
    radius = 1 + 0.4 * np.exp(-(z**2))
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=-1).reshape(-1, 3)
    first, j = np.arange(rows - 1)[:, None] * around, np.arange(around)
    after = (j + 1) % around
    quads = np.stack([first + j, first + after, first + around + after, first + around + j], axis=-1).reshape(-1, 4)
    return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def shear(points):
    """Along the pipe, zero at its ends, with a source and a sink on the bulge."""
    field = np.zeros_like(points)
    field[:, 2] = 1.0
    for place, strength in (([1.4, 0, 0], 5.0), ([-1.4, 0, 0.3], -5.0)):
        away = points - place
        field += strength * away * np.exp(-4 * (away**2).sum(axis=1, keepdims=True))
    return field * (1 - (points[:, [2]] / 3) ** 8)


@pytest.mark.parametrize("where", ["points", "cells"])
def test_wall_shear_of_a_vessel(capsys, tmp_path, where):
    points, triangles = vessel()
    places = points if where == "points" else points[triangles].mean(axis=1)
    data = {"WSS": shear(places)}
    options = {"point_data": data} if where == "points" else {"cell_data": data, "point_data": {"Normals": points}}
    content = analysis(capsys, write_mesh(tmp_path / "wall.vtu", points, triangles, **options), "--vector", "WSS")
    assert kinds(content) == {"source": 1, "sink": 1, "saddle": 2}
    assert content["index_sum"] == content["mesh"]["euler_characteristic"] == 0


@pytest.mark.parametrize("ending", ["vtu", "vtk", "vtp"])
def test_vectors_of_cells_are_averaged_to_points_and_said(capsys, tmp_path, ending):
    """The field is of the cells, tangent to them; normals at points beside it are not taken."""
    data = poly_data(POINTS, TRIANGLES, {"Normals": NORMALS}, {"WSS": flow(CENTRES)})
    if ending == "vtu":
        data = grid(POINTS, TRIANGLES, [5] * len(TRIANGLES), {"Normals": NORMALS}, {"WSS": flow(CENTRES)})
    content = analysis(capsys, write_vtk(tmp_path / f"wall.{ending}", data))
    assert_right(content)
    assert content["read"]["arrays"][0] == {"name": "WSS", "location": "cells", "components": 3, "unit": ""}
    assert changes(content)["cells averaged to points"] == len(TRIANGLES)


def test_points_are_taken_before_cells_of_the_same_name(capsys, tmp_path):
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data={"U": WSS}, cell_data={"U": -flow(CENTRES)})
    content = analysis(capsys, path)
    assert_right(content)
    other = analysis(capsys, path, "--vector", "cells:U")
    assert kinds(other) == {"source": 2, "saddle": 2, "sink": 2}
    assert np.abs(next(p for p in other["fixed_points"] if p["kind"] == "source")["position"])[0] > 0.98


@pytest.mark.parametrize(
    "names",
    [
        ("vx", "vy", "vz"),
        ("Wall Shear X", "Wall Shear Y", "Wall Shear Z"),
        ("U:0", "U:1", "U:2"),
        ("x_wss", "y_wss", "z_wss"),
    ],
)
def test_three_scalars_are_a_vector(capsys, tmp_path, names):
    data = {name: WSS[:, k] for k, name in enumerate(names)} | {"pressure": POINTS[:, 0]}
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data=data)
    assert_right(analysis(capsys, path))
    assert_right(analysis(capsys, path, "--vector", ",".join(names)))


def test_colours_texture_coordinates_numbers_and_copies_of_positions_are_taken_by_name_only(capsys, tmp_path):
    other = {
        "Colors": np.abs(WSS) / np.abs(WSS).max(),
        "Texture Coordinates": np.abs(POINTS),
        "ids": np.arange(3 * len(POINTS)).reshape(-1, 3),
        "coordinates": POINTS + 5.0,
    }
    alone = write_vtk(tmp_path / "no.vtp", poly_data(POINTS + 5.0, TRIANGLES, other))
    line = refused(capsys, "analyze", alone, "--json", "-")
    assert "has no vector" in line and "Colors (points, 3 components)" in line
    both = write_vtk(tmp_path / "w.vtp", poly_data(POINTS + 5.0, TRIANGLES, other | {"WSS": WSS}))
    assert kinds(analysis(capsys, both)) == KINDS
    assert run(capsys, "analyze", alone, "--vector", "Colors", "--json", "-")[0] == 0


def test_points_and_lines_beside_the_faces_do_not_shift_the_data_of_cells(capsys, tmp_path):
    data = with_data(vtkPolyData(), POINTS)
    data.SetVerts(cells_of([[0], [1]]))
    data.SetLines(cells_of([[0, 1], [1, 2, 3]]))
    data.SetPolys(cells_of(list(TRIANGLES)))
    values = with_data(vtkPolyData(), POINTS, {}, {"WSS": np.concatenate([np.full((4, 3), 99.0), flow(CENTRES)])})
    data.GetCellData().ShallowCopy(values.GetCellData())
    assert_right(analysis(capsys, write_vtk(tmp_path / "a.vtp", data)))


def test_vtkhdf(capsys, tmp_path):
    from vtkmodules.vtkIOHDF import vtkHDFWriter

    writer = vtkHDFWriter()
    writer.SetFileName(str(tmp_path / "a.vtkhdf"))
    writer.SetInputData(poly_data(POINTS, TRIANGLES, {"WSS": WSS}))
    writer.Write()
    assert_right(analysis(capsys, tmp_path / "a.vtkhdf"))


def test_a_name_may_hold_commas_and_two_vectors_are_asked_for(capsys, tmp_path):
    name = "Velocity, mean (m/s)"
    path = write_mesh(tmp_path / "a.vtu", POINTS, TRIANGLES, point_data={name: WSS, "other": -WSS})
    assert_right(analysis(capsys, path, "--vector", name))
    line = refused(capsys, "analyze", path, "--json", "-")
    assert str(path) in line and f"{name} (points, 3 components), other (points, 3 components)" in line


def test_two_components_are_a_vector_in_the_plane_only(capsys, tmp_path):
    x, y = np.meshgrid(np.linspace(-1, 1, 20), np.linspace(-1, 1, 20), indexing="ij")
    flat = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    path = write_mesh(
        tmp_path / "flat.vtu", flat, grid_quads(20, 20), "quad", {"u": flat[:, 0] - 0.03, "v": flat[:, 1] + 0.01}
    )
    content = analysis(capsys, path, "--vector", "u,v")
    assert kinds(content) == {"source": 1}
    data = {"u": WSS[:, 0], "v": WSS[:, 1]}
    path = write_mesh(tmp_path / "ball.vtu", POINTS, TRIANGLES, point_data=data)
    assert "2 numbers per vector, and the surface is not flat" in refused(
        capsys, "analyze", path, "--vector", "u,v", "--json", "-"
    )
