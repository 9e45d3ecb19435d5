# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of analyses: what is hidden stays hidden, views fit the surface, files are whole or not there."""

import sys

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

from stormfield import native
from stormfield.analysis.entities import Entity, EntityGraph, Link
from stormfield.analysis.tracking import Bifurcation, TrackedPath, Tracking
from stormfield.figures import image, view
from stormfield.model.errors import InputError
from stormfield.readers.icosphere import icosphere


@pytest.fixture(scope="module")
def sphere():
    data = icosphere(1280)
    return native.TriangleMesh(2.0 * data.vertices, data.triangles)


@pytest.fixture(scope="module")
def square():
    n = 20
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
    a = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    triangles = np.concatenate([np.column_stack([a, a + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + n + 1])])
    return native.TriangleMesh(np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), triangles.astype(np.int32))


def rotation(mesh):
    return np.column_stack([-mesh.vertices[:, 1], mesh.vertices[:, 0], np.zeros(mesh.vertex_count)])


def small_graph():
    orbit = np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    entities = (
        Entity(0, "R1", "source", "repelling", np.zeros(3)),
        Entity(1, "S1", "saddle", "saddle", np.array([0.7, 0.0, 0.0])),
        Entity(2, "A1", "attracting", "attracting", orbit[0], orbit, faces=np.array([3, 4], np.int32)),
    )
    links = (Link(0, 1, (np.linspace([0, 0, 0], [0.7, 0, 0], 9),)), Link(1, 2), Link(0, 2))
    return EntityGraph("Entity connection graph", entities, links, 0.0)


def test_views_fit_the_surface(sphere, square):
    assert [v.title for v in view.choose_views(sphere)] == ["front", "back"]
    (above,) = view.choose_views(square)
    np.testing.assert_allclose(above.axes[2], [0, 0, 1], atol=1e-12)
    wind = icosphere(320)
    (only,) = view.choose_views(native.TriangleMesh(wind.vertices, wind.triangles))
    assert only.is_map


def test_each_point_of_a_sphere_is_seen_from_one_side(sphere):
    front, back = (view.look(sphere, v, 300) for v in view.choose_views(sphere))
    points = sphere.vertices
    normals = points / 2.0
    seen = front.sees(points, normals), back.sees(points, normals)
    rim = np.abs(normals @ front.view.axes[2]) < 0.1
    assert (seen[0] ^ seen[1])[~rim].all()
    np.testing.assert_array_equal(seen[0][~rim], (normals @ front.view.axes[2] > 0)[~rim])


def test_a_near_sheet_hides_a_far_one():
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    points = np.concatenate([corners, 0.5 * corners + [0, 0, 1]])
    quad = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    mesh = native.TriangleMesh(points, np.concatenate([quad, quad + 4]))
    (above,) = view.choose_views(mesh)
    sight = view.look(mesh, above, 200)
    up = np.tile([0.0, 0.0, 1.0], (3, 1))
    seen = sight.sees(np.array([[0.1, 0.2, 0.0], [0.1, 0.2, 1.0], [0.8, 0.8, 0.0]]), up)
    assert seen.tolist() == [False, True, True]
    assert (sight.faces >= 0).mean() > 0.9  # no pinholes inside, a margin around


def test_depth_and_faces_are_exact_on_a_slope():
    pixels = np.array([[0, 0, 0], [40, 0, 40], [0, 40, 0], [40, 40, 40]], float)
    faces, depth = view._depth_buffer(pixels, np.array([[0, 1, 2], [1, 3, 2]]), (40, 40))
    assert (faces >= 0).all()
    np.testing.assert_allclose(depth, np.broadcast_to(np.arange(40) + 0.5, (40, 40)))


@pytest.mark.parametrize("ending", ["png", "pdf"])
def test_analyses_become_files(tmp_path, square, ending):
    path = tmp_path / f"ecg.{ending}"
    image.draw_analysis(path, square, rotation(square), small_graph())
    assert path.stat().st_size > 10_000
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_morse_sets_and_empty_graphs_become_files(tmp_path, sphere):
    sets = np.full(sphere.face_count, -1, np.int32)
    sets[:200] = 2
    image.draw_morse(tmp_path / "mcg.png", sphere, rotation(sphere), small_graph(), sets)
    image.draw_analysis(tmp_path / "none.png", sphere, rotation(sphere), EntityGraph("Graph", (), (), 0.0))
    image.draw_analysis(tmp_path / "zero.png", sphere, np.zeros((sphere.vertex_count, 3)), small_graph())
    assert len(list(tmp_path.iterdir())) == 3


def test_tracking_becomes_a_file(tmp_path, square):
    lambdas = np.linspace(0.0, 1.0, 11)
    positions = np.column_stack([lambdas - 0.5, 0.3 * lambdas, 0.0 * lambdas])
    faces, barycentric, _ = square.closest_points(positions)

    def track(number, kind):
        rest = (lambdas, positions, faces, barycentric, (kind,) * 11, "first", "annihilation", 1.0, 0.0)
        return TrackedPath(number, f"P{number}", kind, 1, *rest)

    event = Bifurcation(0, 1.0, positions[-1], "annihilation", "sink", (0, 1))
    image.draw_tracking(tmp_path / "t.png", square, Tracking((track(0, "sink"), track(1, "saddle")), (event,)))
    image.draw_tracking(tmp_path / "none.png", square, Tracking((), ()))
    assert len(list(tmp_path.iterdir())) == 2


def test_faults_name_their_cure(tmp_path, square, monkeypatch):
    def draw(path):
        image.draw_analysis(path, square, rotation(square), small_graph())

    with pytest.raises(InputError, match="no picture has this ending"):
        draw(tmp_path / "x.xyz")
    with pytest.raises(InputError, match="folder is missing"):
        draw(tmp_path / "nowhere" / "x.png")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(InputError, match="matplotlib"):
        draw(tmp_path / "x.png")
