# SPDX-License-Identifier: GPL-3.0-or-later
"""A design on meshes that are no surfaces: the field lives on what is one, and is told in one line."""

import json

import numpy as np
import pytest
from command_line import run as run_command
from stormfield.bake.lambda_cache import solve_steps
from stormfield.cache.field_cache import open_cache
from stormfield.model.design import Design, Element, SolveSettings
from stormfield.model.mesh_data import MeshData
from stormfield.solve import solve
from stormfield.work import run
from test_manifold import ball, both, grid, split


def eye(point=(0.0, 0.0, 1.0), radius=0.4, **settings):
    element = Element("eye", "singular", (point,), kind="vortex_ccw", radius=radius)
    return Design((element,), SolveSettings(samples=2, **settings))


def vectors(mesh, design):
    """(n, 3) the advection at λ 0 at the vertices of the mesh, and the notes."""
    solution = solve(mesh, design)
    return solution.to_mesh(solution.fields["advection"].sample(0).to_space()), solution.notes


def test_a_split_ball_has_the_field_of_the_whole_one():
    points, triangles = ball()
    whole, _ = vectors(MeshData(points, triangles), eye())
    apart, notes = vectors(MeshData(*split(points, triangles)), eye())
    assert np.allclose(apart, whole[triangles.ravel()], atol=2e-3 * np.abs(whole).max())
    assert len(notes) == 1 and "joined" in notes[0]


def test_islands_are_told_in_one_sentence_with_a_count():
    _, notes = vectors(MeshData(*split(*grid())), eye((0.5, 0.5, 0.0), weld=0.0))
    assert len(notes) == 1
    assert "31 of 32 parts of the mesh have no element" in notes[0]


def test_a_fin_takes_the_nearest_vectors_in_its_own_plane():
    points, triangles = grid()
    row = [10, 11, 12, 13, 14]
    fin = np.array([points[v] + np.array([0, 0, 1]) for v in row])
    lifted = [(row[i], row[i + 1], 25 + i) for i in range(4)] + [(row[i + 1], 26 + i, 25 + i) for i in range(4)]
    mesh = MeshData(np.concatenate([points, fin]), np.concatenate([triangles, lifted]))
    design = Design((Element("wind", "regular", ((2.0, 1.0, 0.0),), radius=3.0, direction=(1.0, 0.0, 0.0)),))
    values, notes = vectors(mesh, design)
    plain, _ = vectors(MeshData(points, triangles), design)
    plain *= np.sqrt(20 / 16)  # speeds are in sizes of the whole object
    assert np.allclose(values[:25], plain, atol=1e-3 * np.abs(plain).max())
    assert np.abs(values[25:, 1]).max() < 1e-9  # the fin stands in the plane y = 2
    assert (np.linalg.norm(values[25:], axis=1) > 0.5 * np.linalg.norm(plain[row], axis=1)).all()
    assert len(notes) == 1 and "1 part without element took the nearest vectors" in notes[0]


@pytest.mark.parametrize("inward", [False, True])
def test_left_turns_left_seen_from_outside_whatever_the_normals_say(inward):
    points, triangles = ball()
    values, notes = vectors(MeshData(points, triangles[:, ::-1] if inward else triangles), eye())
    near = (points[:, 2] > 0.85) & (points[:, 2] < 0.999)
    left = np.cross((0, 0, 1), points[near])
    assert (np.einsum("ij,ij->i", left, values[near]) > 0).all()
    assert any("normals point inward" in note for note in notes) == inward


def test_a_cache_of_a_mesh_with_faults_has_a_vector_at_every_vertex(tmp_path):
    points, triangles = both(ball(), (np.array([(5, 5, 5)]), np.zeros((0, 3), int)))
    extra = np.array([triangles[0], (0, 0, 1)])
    mesh = MeshData(points, np.concatenate([triangles, extra]))
    cache = open_cache(run(solve_steps(mesh, eye(), tmp_path)))
    sample = cache.sample(0)
    assert {len(values) for values in sample.values()} == {len(points)}
    assert np.isfinite(sample["sf_advection"]).all()
    assert not sample["sf_advection"][-1].any()  # a vertex without faces


def test_the_command_line_reports_the_surface_that_was_solved(tmp_path, capsys):
    points, triangles = grid()
    triangles = np.concatenate([triangles, [(0, 0, 1), triangles[0]]])
    source = {"vertices": points.tolist(), "triangles": triangles.tolist()}
    design, report = tmp_path / "design.json", tmp_path / "report.json"
    design.write_text(json.dumps(eye((2.0, 2.0, 0.0)).to_json(source)))
    status, _out, _err = run_command(capsys, "solve", design, "--out", tmp_path / "cache", "--json", report)
    assert status == 0
    assert json.loads(report.read_text())["mesh"]["faces"] == 32
