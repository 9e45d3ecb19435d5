# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as other programs write them: the right answer, or a refusal in words; never a wrong one in silence."""

import json
import subprocess
import sys
from collections import Counter

import meshio
import numpy as np
import pytest
from command_line import refused, run
from surface_cases import (
    KINDS,
    ball,
    cells_of,
    flow,
    grid,
    grid_quads,
    grid_sphere,
    poly_data,
    second_order,
    with_data,
    write_mesh,
    write_pvd,
    write_vtk,
    write_xdmf,
)  # fmt: skip
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData, vtkStructuredGrid

POINTS, TRIANGLES = ball()
WSS = flow(POINTS)
NORMALS = POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True)
CENTRES = POINTS[TRIANGLES].mean(axis=1)


def analysis(capsys, path, *options):
    status, out, err = run(capsys, "analyze", path, *options, "--json", "-")
    assert status == 0, err
    content = json.loads(out)
    assert err.count("\n") == 1 and err.startswith(f"read: {path}")
    return content


def kinds(content):
    return Counter(point["kind"] for point in content["fixed_points"])


def assert_right(content):
    """Six fixed points at the ends of the axes, of a closed sphere in one piece."""
    assert kinds(content) == KINDS
    assert content["index_sum"] == content["mesh"]["euler_characteristic"] == 2
    assert content["mesh"]["components"] == 1 and content["mesh"]["boundary_loops"] == 0
    for point in content["fixed_points"]:
        place = np.abs(point["position"])
        axis = {"source": 2, "saddle": 1, "sink": 0}[point["kind"]]
        assert place[axis] > 0.98 * np.linalg.norm(place), point


def changes(content):
    return content["read"]["changes"]


# Formats and where vectors are --------------------------------------------------------------------------------------


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


# Normals --------------------------------------------------------------------------------------------------------------


def scalars(names, vectors):
    return {name: vectors[:, k].astype(np.float32) for k, name in enumerate(names)}


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


# Points that a file has more than once --------------------------------------------------------------------------------


@pytest.mark.parametrize("precision", [np.float64, np.float32])
@pytest.mark.parametrize("offset", [0.0, 30.0])
def test_points_split_per_cell_are_welded(capsys, tmp_path, precision, offset):
    split = (POINTS[TRIANGLES].reshape(-1, 3) + offset).astype(precision)
    data = {"WSS": WSS[TRIANGLES].reshape(-1, 3).astype(precision)}
    path = write_mesh(tmp_path / "split.vtu", split, np.arange(len(split)).reshape(-1, 3), point_data=data)
    content = analysis(capsys, path)
    assert kinds(content) == KINDS and content["mesh"]["components"] == 1 and content["mesh"]["vertices"] == len(POINTS)
    assert changes(content)["points welded"] == len(split) - len(POINTS)


def test_values_that_jump_between_cells_are_averaged_and_said(capsys, tmp_path):
    split = POINTS[TRIANGLES].reshape(-1, 3)
    jump = np.repeat(np.random.default_rng(1).normal(0, 0.02, (len(TRIANGLES), 3)), 3, axis=0)
    path = write_mesh(
        tmp_path / "dg.vtu",
        split,
        np.arange(len(split)).reshape(-1, 3),
        point_data={"WSS": WSS[TRIANGLES].reshape(-1, 3) + jump},
    )
    content = analysis(capsys, path)
    assert content["mesh"]["components"] == 1 and content["index_sum"] == 2
    assert changes(content)["points averaged where cells disagree"] == len(split)


def test_cells_of_split_points_are_averaged_over_the_welded_surface(capsys, tmp_path):
    split = POINTS[TRIANGLES].reshape(-1, 3)
    each = np.arange(len(split)).reshape(-1, 3)
    assert_right(analysis(capsys, write_mesh(tmp_path / "s.vtu", split, each, cell_data={"WSS": flow(CENTRES)})))


def test_a_sphere_from_a_grid_with_seam_and_poles(capsys, tmp_path):
    points, quads = grid_sphere()
    path = write_mesh(tmp_path / "grid.vtu", points, quads, "quad", {"WSS": flow(points)})
    content = analysis(capsys, path)
    assert_right(content)
    assert changes(content)["faces without area dropped"] == 2 * 47
    assert content["mesh"]["vertices"] == 22 * 47 + 2
    assert (
        changes(content)["points welded"] + changes(content)["points of no face left out"] == len(points) - 22 * 47 - 2
    )


@pytest.mark.parametrize("ending", ["vts", "vtk"])
def test_structured_grids(capsys, tmp_path, ending):
    points, _ = grid_sphere(24, 48)
    data = with_data(vtkStructuredGrid(), points, {"WSS": flow(points)})
    data.SetDimensions(48, 24, 1)
    assert_right(analysis(capsys, write_vtk(tmp_path / f"grid.{ending}", data)))


def test_a_torus_with_both_seams_doubled_keeps_its_orbits(capsys, tmp_path):
    big, small = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, 2 * np.pi, 25), indexing="ij")
    ring = 2 + np.cos(small)
    points = np.stack([ring * np.cos(big), ring * np.sin(big), np.sin(small)], axis=-1).reshape(-1, 3)
    around = np.stack([-np.sin(big), np.cos(big), 0 * big], axis=-1).reshape(-1, 3)
    across = np.stack([-np.sin(small) * np.cos(big), -np.sin(small) * np.sin(big), np.cos(small)], axis=-1).reshape(
        -1, 3
    )
    field = around + 0.6 * np.sin(small.ravel() + 0.1)[:, None] * across
    path = write_mesh(tmp_path / "torus.vtu", points, grid_quads(49, 25), "quad", {"U": field})
    content = analysis(capsys, path)
    assert content["mesh"]["euler_characteristic"] == 0 and content["mesh"]["boundary_loops"] == 0
    assert Counter(orbit["kind"] for orbit in content["periodic_orbits"]) == {"attracting": 1, "repelling": 1}


def test_a_crack_stays_open_and_is_said(capsys, tmp_path):
    """A slit in a plane whose sides move apart: coincident points of one piece that differ."""
    n = 21
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    points, quads = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1), grid_quads(n, n)
    slit = np.flatnonzero((points[:, 1] == 0) & (np.abs(points[:, 0]) < 0.55))
    double = {int(p): len(points) + k for k, p in enumerate(slit)}
    upper = points[quads].mean(axis=1)[:, 1] > 0
    quads[upper] = np.vectorize(lambda p: double.get(int(p), p))(quads[upper])
    points = np.concatenate([points, points[slit]])
    side = np.zeros((len(points), 3))
    side[:, 0] = 1.0
    side[len(points) - len(slit) :, 0] = -1.0
    content = analysis(capsys, write_mesh(tmp_path / "slit.vtu", points, quads, "quad", {"U": side}))
    assert content["mesh"]["boundary_loops"] == 2
    assert changes(content)["coincident points of different vectors left apart"] == 2 * len(slit)


def test_surfaces_that_touch_stay_apart(capsys, tmp_path):
    points = np.concatenate([POINTS, POINTS + np.array([2.0, 0, 0])])
    both = np.concatenate([TRIANGLES, TRIANGLES + len(POINTS)])
    assert np.linalg.norm(POINTS - [1, 0, 0], axis=1).min() < 1e-9
    content = analysis(
        capsys, write_mesh(tmp_path / "two.vtu", points, both, point_data={"U": np.concatenate([WSS, WSS])})
    )
    assert content["mesh"]["components"] == 2 and content["mesh"]["euler_characteristic"] == 4


def test_a_heap_of_faces_is_refused(capsys, tmp_path):
    apart = (POINTS[TRIANGLES] + 0.01 * CENTRES[:, None] * np.arange(len(TRIANGLES))[:, None, None]).reshape(-1, 3)
    path = write_mesh(tmp_path / "heap.vtu", apart, np.arange(len(apart)).reshape(-1, 3), point_data={"U": flow(apart)})
    assert "share no points" in refused(capsys, "analyze", path, "--json", "-")


def test_points_of_no_face_are_left_out_even_where_their_vectors_are_not_finite(capsys, tmp_path):
    points = np.concatenate([[[9.0, 9, 9]], POINTS, [[5.0, 5, 5]]])
    field = np.concatenate([[[np.nan] * 3], WSS, [[np.inf] * 3]])
    content = analysis(capsys, write_mesh(tmp_path / "a.vtu", points, TRIANGLES + 1, point_data={"U": field}))
    assert_right(content)
    assert content["mesh"]["vertices"] == len(POINTS) and changes(content)["points of no face left out"] == 2


# Kinds of cells -------------------------------------------------------------------------------------------------------


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


def ball_of_tetrahedra():
    points = np.concatenate([POINTS, [[0.0, 0, 0]]])
    return points, np.column_stack([TRIANGLES, np.full(len(TRIANGLES), len(POINTS))])


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


# Fields beside a mesh -------------------------------------------------------------------------------------------------


def write_off(path, header="OFF"):
    rows = [" ".join(map(repr, row)) for row in POINTS.tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in TRIANGLES]
    path.write_text(f"{header}\n# a comment\n{len(POINTS)} {len(TRIANGLES)} 0\n" + "\n".join(rows) + "\n")
    return path


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


# Numbers --------------------------------------------------------------------------------------------------------------


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


# Files that are broken ------------------------------------------------------------------------------------------------


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
