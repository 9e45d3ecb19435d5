# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that a file has more than once, and pieces that stay apart."""

from collections import Counter

import numpy as np
import pytest
from command_line import refused
from surface_answers import CENTRES, POINTS, TRIANGLES, WSS, analysis, assert_right, changes, kinds
from surface_cases import (
    KINDS,
    flow,
    grid_quads,
    grid_sphere,
    with_data,
    write_mesh,
    write_vtk,
)  # fmt: skip
from vtkmodules.vtkCommonDataModel import vtkStructuredGrid


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
