# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells of every kind become triangles, all of the surface."""

import json

import meshio
import numpy as np
from command_line import refused, run
from surface_answers import CENTRES, POINTS, TRIANGLES, WSS, analysis, assert_right, ball_of_tetrahedra, changes
from surface_cases import (
    cells_of,
    flow,
    grid,
    grid_sphere,
    poly_data,
    second_order,
    with_data,
    write_mesh,
    write_pvd,
    write_vtk,
)  # fmt: skip
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData


def test_second_order_triangles_alone_and_beside_others_are_all_of_the_surface(capsys, tmp_path):
    points, corners = second_order(POINTS, TRIANGLES)
    path = write_vtk(tmp_path / "t6.vtu", grid(points, corners, [22] * len(corners), {"WSS": flow(points)}))
    content = analysis(capsys, path)
    assert_right(content)
    assert content["mesh"]["faces"] == 4 * len(TRIANGLES)
    north = CENTRES[:, 2] > 0
    # Both halves share straight edges only where the second order is taken by its corners.
    cells = [row[:3] if up else row for row, up in zip(corners, north, strict=True)]
    mixed = grid(points, cells, np.where(north, 5, 22), {"WSS": flow(points)})
    content = analysis(capsys, write_vtk(tmp_path / "part.vtu", mixed))
    assert_right(content)
    assert content["mesh"]["faces"] == len(TRIANGLES)
    assert changes(content)["cells of second order taken by their corners"] == (~north).sum()


def test_second_order_quads_and_cells(capsys, tmp_path):
    points, quads = grid_sphere(13, 25)
    middles = np.concatenate([points[quads[:, [k, (k + 1) % 4]]].mean(axis=1) for k in range(4)])
    middles /= np.maximum(np.linalg.norm(middles, axis=1, keepdims=True), 1e-12)
    corners = np.column_stack([quads, len(points) + np.arange(4 * len(quads)).reshape(4, -1).T])
    every = np.concatenate([points, middles])
    path = write_vtk(tmp_path / "q8.vtu", grid(every, corners, [23] * len(quads), {"WSS": flow(every)}))
    content = analysis(capsys, path)
    assert_right(content)


def test_strips(capsys, tmp_path):
    """A sphere from a grid, each band between two latitudes one strip."""
    points, _ = grid_sphere(24, 48)
    strips = [np.stack([np.arange(48) + 48 * row, np.arange(48) + 48 * (row + 1)], axis=1).ravel() for row in range(23)]
    data = with_data(vtkPolyData(), points, {"WSS": flow(points)})
    data.SetStrips(cells_of(strips))
    content = analysis(capsys, write_vtk(tmp_path / "strips.vtp", data))
    assert_right(content)
    assert changes(content)["polygons or strips cut into triangles"] == 23
    assert_right(
        analysis(capsys, write_vtk(tmp_path / "strips.vtu", grid(points, strips, [6] * 23, {"WSS": flow(points)})))
    )


def test_polygons_of_many_corners(capsys, tmp_path):
    """The dual of the triangles: hexagons and pentagons, cut by VTK."""
    around = [np.flatnonzero((v == TRIANGLES).any(axis=1)) for v in range(len(POINTS))]

    def ordered(v, faces):
        a = np.cross(POINTS[v], [0.3, 0.5, 0.8])
        b = np.cross(POINTS[v], a)
        return faces[np.argsort(np.arctan2(CENTRES[faces] @ b, CENTRES[faces] @ a))]

    polygons = [ordered(v, faces) for v, faces in enumerate(around)]
    points = CENTRES / np.linalg.norm(CENTRES, axis=1, keepdims=True)
    for name, data in (
        ("dual.vtp", poly_data(points, polygons, {"WSS": flow(points)})),
        ("dual.vtu", grid(points, polygons, [7] * len(polygons), {"WSS": flow(points)})),
    ):
        content = analysis(capsys, write_vtk(tmp_path / name, data))
        assert_right(content)
        assert content["mesh"]["vertices"] == len(points)


def test_a_polygon_that_crosses_itself_leaves_no_hole(capsys, tmp_path):
    points = np.array([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0], [-1, 0.5, 0]], float)
    path = write_vtk(tmp_path / "star.vtp", poly_data(points, [[0, 1, 2, 3, 4]], {"U": points + 1}))
    line = refused(capsys, "analyze", path, "--json", "-")
    assert "cross themselves" in line and str(path) in line


def test_a_volume_is_its_outside_and_that_is_said(capsys, tmp_path):
    points, cells = ball_of_tetrahedra()
    field = np.concatenate([WSS, [[9.0, 9, 9]]])
    content = analysis(capsys, write_mesh(tmp_path / "v.vtu", points, cells, "tetra", {"U": field}))
    assert_right(content)
    assert changes(content)["volume cells whose outside is taken"] == len(cells)
    content = analysis(
        capsys, write_mesh(tmp_path / "v.msh", points, cells, "tetra", {"U": field}, file_format="gmsh22")
    )
    assert_right(content)


def test_a_surface_beside_its_volume_is_taken_once(capsys, tmp_path):
    points, cells = ball_of_tetrahedra()
    both = meshio.Mesh(
        points, [("triangle", TRIANGLES), ("tetra", cells), ("line", [[0, 1]]), ("vertex", [[0]])],
        point_data={"U": np.concatenate([WSS, [[0.0, 0, 0]]])},
    )  # fmt: skip
    meshio.write(tmp_path / "both.vtu", both)
    content = analysis(capsys, tmp_path / "both.vtu")
    assert_right(content)
    assert changes(content)["volume cells left out beside the surface"] == len(cells)


def blocks(**parts):
    data = vtkMultiBlockDataSet()
    for number, (name, part) in enumerate(parts.items()):
        data.SetBlock(number, part)
        data.GetMetaData(number).Set(vtkMultiBlockDataSet.NAME(), name)
    return data


def test_blocks_are_one_surface_and_those_left_out_are_named(capsys, tmp_path):
    north = CENTRES[:, 2] > 0
    wall = {
        name: poly_data(POINTS, TRIANGLES[side], {"WSS": WSS}) for name, side in (("north", north), ("south", ~north))
    }
    far = poly_data(POINTS + 9, TRIANGLES, {"pressure": POINTS[:, 0]})
    content = analysis(capsys, write_vtk(tmp_path / "wall.vtm", blocks(**wall, inlet=far)))
    assert_right(content)
    assert content["read"]["notes"] == ["blocks without WSS left out: inlet"]


def test_parts_that_overlap_in_ghost_cells_are_one_surface(capsys, tmp_path):
    entries = []
    up = CENTRES[:, 2]
    for name, own, side in (("north", up >= 0, up > -0.3), ("south", up < 0, up < 0.3)):
        ghost = {"vtkGhostType": (~own[side]).astype(np.uint8)}
        part = grid(POINTS, TRIANGLES[side], [5] * side.sum(), {"WSS": WSS}, ghost)
        entries.append((2.5, len(entries), write_vtk(tmp_path / f"{name}.vtu", part).name))
    status, out, _ = run(capsys, "analyze", write_pvd(tmp_path / "wall.pvd", entries), "--json", "-")
    content = json.loads(out)
    assert status == 0
    assert_right(content)
    assert content["mesh"]["faces"] == len(TRIANGLES) and content["read"]["times"] == [2.5]
    assert changes(content)["ghost cells, which other parts have too, left out"] > 0


def test_a_block_given_twice_is_taken_once(capsys, tmp_path):
    wall = poly_data(POINTS, TRIANGLES, {"WSS": WSS})
    assert_right(analysis(capsys, write_vtk(tmp_path / "wall.vtm", blocks(a=wall, b=wall))))
