# SPDX-License-Identifier: GPL-3.0-or-later
"""TriangleMesh in Python: what it reports, and what it refuses at the boundary."""

import numpy as np
import pytest
import stormfield_native as native
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

VERTICES = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=np.float64)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], dtype=np.int32)
finite = st.floats(-10, 10, width=64)


@pytest.fixture(scope="module")
def mesh():
    return native.TriangleMesh(VERTICES, TRIANGLES)


def test_reports_its_topology_and_size(mesh):
    assert (mesh.vertex_count, mesh.face_count, mesh.edge_count) == (4, 4, 6)
    assert (mesh.component_count, mesh.boundary_loop_count, mesh.euler_characteristic) == (1, 0, 2)
    assert mesh.flipped_face_count == 0
    assert mesh.components.tolist() == [0, 0, 0, 0]
    assert mesh.total_area == pytest.approx(8 * np.sqrt(3))
    assert mesh.size == pytest.approx(np.sqrt(mesh.total_area))
    assert mesh.mean_edge_length == pytest.approx(np.sqrt(8))
    np.testing.assert_allclose(np.abs(mesh.normals), 1 / np.sqrt(3))


def test_reports_areas_and_unit_normals_of_its_faces(mesh):
    np.testing.assert_allclose(mesh.face_areas, 2 * np.sqrt(3))
    corners = mesh.vertices[mesh.triangles]
    np.testing.assert_allclose(mesh.face_normals, corners.mean(axis=1) * np.sqrt(3), atol=1e-12)
    assert mesh.face_areas.sum() == pytest.approx(mesh.total_area)


def test_gives_its_arrays_back_read_only(mesh):
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)
    assert mesh.triangles.dtype == np.int32
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0] = 0


def test_views_outlive_the_mesh():
    view = native.TriangleMesh(VERTICES, TRIANGLES).vertices
    np.testing.assert_array_equal(view, VERTICES)


def test_accepts_any_strides(mesh):
    doubled = np.repeat(VERTICES, 2, axis=0)[::2]
    assert native.TriangleMesh(np.asfortranarray(VERTICES), TRIANGLES).total_area == mesh.total_area
    assert native.TriangleMesh(doubled, np.asfortranarray(TRIANGLES)).total_area == mesh.total_area


@pytest.mark.parametrize(
    ("vertices", "triangles", "words"),
    [
        (VERTICES.astype(np.float32), TRIANGLES, ["vertices", "float32", "astype('float64')"]),
        (VERTICES, TRIANGLES.astype(np.int64), ["triangles", "int64", "astype('int32')"]),
        (VERTICES.tolist(), TRIANGLES, ["vertices", "list", "numpy array"]),
        (None, TRIANGLES, ["vertices", "NoneType"]),
        (VERTICES[:, :2].copy(), TRIANGLES, ["vertices", "(4, 2)", "(n, 3)"]),
        (VERTICES.ravel(), TRIANGLES, ["vertices", "(12,)", "(n, 3)"]),
        (VERTICES, TRIANGLES[None], ["triangles", "(1, 4, 3)"]),
    ],
)
def test_refuses_arrays_that_do_not_fit(vertices, triangles, words):
    with pytest.raises(native.InputError) as fault:
        native.TriangleMesh(vertices, triangles)
    assert not isinstance(fault.value, native.MeshError)
    for word in words:
        assert word in str(fault.value)


def test_refuses_what_is_not_a_surface():
    broken = VERTICES.copy()
    broken[2, 1] = np.nan
    for vertices, triangles, words in [
        (broken, TRIANGLES, "vertex 2 .* not finite"),
        (VERTICES, TRIANGLES[:0], "no faces"),
        (VERTICES, TRIANGLES + 1, "vertex 4"),
        (VERTICES, np.vstack([TRIANGLES, TRIANGLES[:1]]), "face 4 has the same corners as face 0"),
    ]:
        with pytest.raises(native.MeshError, match=words):
            native.TriangleMesh(vertices, triangles)


def test_exceptions_form_a_family():
    assert issubclass(native.MeshError, native.InputError)
    assert issubclass(native.InputError, ValueError)
    assert issubclass(native.SolverError, RuntimeError)
    assert native.Cancelled.__doc__


@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=1, max_dims=3, max_side=5), elements=finite))
def test_any_shape_is_taken_or_refused_cleanly(mesh, array):
    if array.ndim == 2 and array.shape[1] == 3:
        faces, barycentric, distances = mesh.closest_points(array)
        assert faces.shape == distances.shape == array.shape[:1]
        np.testing.assert_allclose(barycentric.sum(axis=1), 1)
        found = mesh.positions(faces, barycentric)
        np.testing.assert_allclose(np.linalg.norm(found - array, axis=1), distances, atol=1e-12)
    else:
        with pytest.raises(native.InputError, match="points has shape"):
            mesh.closest_points(array)


@given(
    hnp.arrays(np.float64, (4, 3), elements=st.floats(width=64)),
    hnp.arrays(np.int32, (5, 3), elements=st.integers(-2, 5)),
)
@settings(max_examples=300)
def test_any_soup_is_a_surface_or_refused(vertices, triangles):
    try:
        mesh = native.TriangleMesh(vertices, triangles)
    except native.MeshError as fault:
        assert str(fault)
    else:
        assert mesh.face_count == 5


def test_closest_points_refuses_what_is_not_finite(mesh):
    with pytest.raises(native.InputError, match="query point 1"):
        mesh.closest_points(np.array([[0.0, 0, 0], [np.inf, 0, 0]]))


def test_positions_refuses_points_off_their_faces(mesh):
    centre = np.full((1, 3), 1 / 3)
    with pytest.raises(native.InputError, match=r"faces\[0\] is 4"):
        mesh.positions(np.array([4], np.int32), centre)
    for bad in (2 * centre, np.array([[-1.0, 1, 1]]), np.full((1, 3), np.nan)):
        with pytest.raises(native.InputError, match=r"barycentric\[0\]"):
            mesh.positions(np.array([0], np.int32), bad)
    with pytest.raises(native.InputError, match="reshape"):
        mesh.positions(np.array([0, 1], np.int32), centre)


@given(hnp.arrays(np.complex128, (2, 3, 4), elements=st.complex_numbers(max_magnitude=1e6, allow_nan=False)))
def test_tangent_vectors_survive_the_way_to_space(mesh, values):
    space = mesh.to_space(values)
    assert space.shape == (2, 3, 4, 3)
    np.testing.assert_allclose(mesh.to_tangent(space), values, atol=1e-8)
    np.testing.assert_allclose((space * mesh.normals).sum(axis=-1), 0, atol=1e-8)


def test_conversions_refuse_wrong_shapes(mesh):
    with pytest.raises(native.InputError, match=r"\(\.\.\., 4, 3\)"):
        mesh.to_tangent(np.zeros((5, 3)))
    with pytest.raises(native.InputError, match=r"\(\.\.\., 4\)"):
        mesh.to_space(np.zeros(5, complex))
