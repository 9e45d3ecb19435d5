# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes refined inside the solve: the same surface, the same first vertices, the field of the fine mesh."""

import numpy as np
import pytest
from stormfield import native
from stormfield.model.design import Design, Element, SolveSettings
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.model.refinement import refined
from stormfield.solve import solve
from test_manifold import ball, cube, grid, split


@pytest.mark.parametrize("make", [grid, cube, ball])
def test_the_surface_is_the_same(make):
    points, triangles = make()
    mesh = MeshData(points, triangles)
    fine = refined(mesh, 0.2)
    before = native.TriangleMesh(mesh.vertices, mesh.triangles)
    after = native.TriangleMesh(fine.vertices, fine.triangles)
    assert np.array_equal(fine.vertices[: len(points)], points)
    assert after.euler_characteristic == before.euler_characteristic
    assert np.isclose(after.face_areas.sum(), before.face_areas.sum())
    edges = fine.vertices[fine.triangles] - np.roll(fine.vertices[fine.triangles], 1, axis=1)
    assert np.linalg.norm(edges, axis=2).max() <= 0.2


def test_a_fine_mesh_stays_as_it_is():
    mesh = MeshData(*grid())
    assert refined(mesh, 2.0) is mesh and refined(mesh, 0.0) is mesh


def test_what_the_core_must_name_is_left_to_it():
    points, triangles = grid()
    points[3] = np.nan
    mesh = MeshData(points, triangles)
    assert refined(mesh, 0.1) is mesh
    wrong = MeshData(grid()[0], triangles + 20)
    assert refined(wrong, 0.1) is wrong


def test_too_many_faces_are_refused_in_words():
    with pytest.raises(InputError, match="solve on longer edges"):
        refined(MeshData(*grid()), 1e-4)


def test_the_mesh_takes_the_field_of_the_fine_one():
    points, triangles = cube()
    element = Element("eye", "singular", ((0.4, 0.6, 1.0),), kind="vortex_ccw", radius=0.3)
    fine = refined(MeshData(points, triangles), 0.1)
    reference = solve(fine, Design((element,), SolveSettings(samples=2)))
    expected = reference.fields["advection"].sample(0).to_space()[: len(points)]
    for mesh in (MeshData(points, triangles), MeshData(*split(points, triangles))):
        solution = solve(mesh, Design((element,), SolveSettings(samples=2, edge=0.1)))
        found = solution.to_mesh(solution.fields["advection"].sample(0).to_space())
        assert len(found) == len(mesh.vertices)
        wanted = expected if len(found) == len(points) else expected[triangles.ravel()]
        assert np.allclose(found, wanted, atol=2e-2 * np.abs(expected).max())


@pytest.mark.parametrize("edge", [-1.0, float("nan")])
def test_edges_that_are_no_lengths_are_refused(edge):
    with pytest.raises(InputError, match="edge is"):
        SolveSettings(edge=edge).check()
