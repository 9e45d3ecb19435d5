# SPDX-License-Identifier: GPL-3.0-or-later
"""VectorField, ParameterizedField and fixed points in Python, on small meshes and on the thesis's data."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import stormfield_native as native
from data_sets import data_set
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp


def square(cells: int) -> native.TriangleMesh:
    axis = np.linspace(-1, 1, cells + 1)
    x, y = np.meshgrid(axis, axis)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    a, b, c, d = corner, corner + 1, corner + cells + 2, corner + cells + 1
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return native.TriangleMesh(np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), triangles.astype(np.int32))


@pytest.fixture(scope="module")
def mesh():
    return square(8)


@pytest.fixture(scope="module")
def octahedron():
    vertices = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], dtype=float)
    triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return native.TriangleMesh(vertices, np.array(triangles, dtype=np.int32))


def test_evaluates_linear_fields_exactly(mesh):
    matrix = np.array([[1.0, 2], [-3, 0.5]])
    vectors = np.zeros_like(mesh.vertices)
    vectors[:, :2] = mesh.vertices[:, :2] @ matrix.T
    field = native.VectorField.from_space(mesh, vectors)
    assert field.mesh is mesh
    np.testing.assert_allclose(field.to_space(), vectors, atol=1e-14)
    faces, barycentric, _ = mesh.closest_points(np.array([[0.3, 0.1, 0], [-0.77, 0.5, 0]]))
    np.testing.assert_allclose(field.evaluate(faces, barycentric)[:, :2], [[0.5, -0.85], [0.23, 2.56]], atol=1e-13)


@pytest.mark.parametrize(
    ("matrix", "kind", "index"),
    [
        ([[1, 0], [0, 1]], "source", 1),
        ([[-1, 0], [0, -2]], "sink", 1),
        ([[1, 0], [0, -1]], "saddle", -1),
        ([[0, -1], [1, 0]], "center", 1),
    ],
)
def test_finds_the_fixed_point_of_a_linear_field(mesh, matrix, kind, index):
    centre = np.array([0.13, -0.41, 0])
    vectors = np.zeros_like(mesh.vertices)
    vectors[:, :2] = (mesh.vertices - centre)[:, :2] @ np.array(matrix, dtype=float).T
    (point,) = native.fixed_points(native.VectorField.from_space(mesh, vectors))
    assert (point.kind, point.index) == (kind, index)
    np.testing.assert_allclose(point.position, centre, atol=1e-13)
    np.testing.assert_allclose(
        mesh.positions(np.array([point.face], np.int32), point.barycentric[None])[0], point.position
    )
    assert np.linalg.det(point.jacobian) == pytest.approx(np.linalg.det(np.array(matrix, dtype=float)))
    assert point.rotation == pytest.approx(matrix[1][0] - matrix[0][1], abs=1e-12)
    assert kind in repr(point)


def test_fixed_points_refuses_tolerances_out_of_range(mesh):
    field = native.VectorField(mesh, np.ones(mesh.vertex_count, complex))
    for bad in (-1.0, 1.0, np.nan):
        with pytest.raises(native.InputError, match="relative_tolerance"):
            native.fixed_points(field, bad)


@given(hnp.arrays(np.complex128, 6, elements=st.complex_numbers(max_magnitude=1e300, allow_nan=False)))
def test_indices_of_any_field_add_up(octahedron, values):
    field = native.VectorField(octahedron, values)
    assert field.poincare_indices().sum() == 2
    assert sum(point.index for point in native.fixed_points(field)) == 2


def test_field_refuses_what_does_not_fit(mesh):
    count = mesh.vertex_count
    with pytest.raises(native.InputError, match="3 vectors"):
        native.VectorField(mesh, np.zeros(3, complex))
    with pytest.raises(native.InputError, match=r"values.*float64.*complex128"):
        native.VectorField(mesh, np.zeros(count))
    with pytest.raises(native.InputError, match=r"vectors has shape"):
        native.VectorField.from_space(mesh, np.zeros((count, 2)))
    values = np.zeros(count, complex)
    values[5] = complex(0, np.inf)
    with pytest.raises(native.InputError, match="vertex 5"):
        native.VectorField(mesh, values)


@given(hnp.arrays(np.float64, st.integers(0, 4), elements=st.floats(width=64)))
def test_any_lambdas_are_taken_or_refused(octahedron, lambdas):
    good = len(lambdas) > 0 and (lambdas >= 0).all() and (lambdas <= 1).all() and (np.diff(lambdas) > 0).all()
    values = np.zeros((len(lambdas), 6), complex)
    if good:
        assert native.ParameterizedField(octahedron, lambdas, values).lambdas.tolist() == lambdas.tolist()
    else:
        with pytest.raises(native.InputError, match=r"lambda|samples"):
            native.ParameterizedField(octahedron, lambdas, values)


def test_parameterized_field_is_linear_between_samples(octahedron):
    rng = np.random.default_rng(1)
    values = rng.normal(size=(3, 6)) + 1j * rng.normal(size=(3, 6))
    field = native.ParameterizedField(octahedron, np.array([0, 0.5, 1]), values)
    np.testing.assert_array_equal(field.values, values)
    np.testing.assert_array_equal(field.sample(2).values, values[2])
    np.testing.assert_allclose(field.at(0.125).values, 0.75 * values[0] + 0.25 * values[1])
    np.testing.assert_array_equal(field.at(7.0).values, values[2])
    assert field.at(0.5).mesh is octahedron
    with pytest.raises(native.InputError, match="sample 3"):
        field.sample(3)
    with pytest.raises(native.InputError, match="values has shape"):
        native.ParameterizedField(octahedron, np.array([0.0]), values)


def test_progress_starts_at_nothing():
    progress = native.Progress()
    assert (progress.fraction, progress.cancelled) == (0.0, False)
    progress.cancel()
    assert progress.cancelled


def read_t(path: Path):
    numbers = np.array(path.read_text().split(), dtype=float)
    faces, vertices = int(numbers[0]), int(numbers[1])
    ends = np.cumsum([2, 3 * faces, 3 * vertices, 3 * vertices])
    triangles, points, vectors = (numbers[a:b].reshape(-1, 3) for a, b in pairwise(ends))
    return points.copy(), triangles.astype(np.int32), vectors.copy()


def read_ply(path: Path):
    lines = path.read_text().splitlines()
    header = [line.split() for line in lines[: lines.index("end_header")]]
    counts = {words[1]: int(words[2]) for words in header if words[0] == "element"}
    names = [words[-1] for words in header if words[0] == "property" and words[1] != "list"]
    first = lines.index("end_header") + 1
    rows = np.array([line.split() for line in lines[first : first + counts["vertex"]]], dtype=float)
    faces = lines[first + counts["vertex"] : first + counts["vertex"] + counts["face"]]
    columns = {name: rows[:, i] for i, name in reversed(list(enumerate(names))) if i < rows.shape[1]}
    return (
        np.stack([columns[c] for c in ("x", "y", "z")], 1),
        np.array([line.split()[1:4] for line in faces], dtype=np.int32),
        np.stack([columns[c] for c in ("nx", "ny", "nz")], 1),
    )


@pytest.mark.parametrize(
    ("name", "faces", "euler"),
    [
        ("gasEngineV.t", 26298, 2),
        ("bunny1V.t", 12000, 2),
        ("torus1V.t", 9216, 0),
        ("sphere1.ply", 8192, 2),
        ("simple_fld2.ply", 6144, None),
    ],
)
def test_real_fields_keep_the_index_theorem(name, faces, euler):
    path = data_set(name)
    points, triangles, vectors = (read_t if path.suffix == ".t" else read_ply)(path)
    mesh = native.TriangleMesh(points, triangles)
    assert mesh.face_count == faces
    field = native.VectorField.from_space(mesh, vectors)
    found = native.fixed_points(field)
    if euler is not None:
        assert mesh.euler_characteristic == euler
        assert sum(point.index for point in found) == euler
    where = np.array([point.face for point in found], dtype=np.int32)
    size = np.linalg.norm(field.evaluate(where, np.array([point.barycentric for point in found])), axis=1)
    assert (size <= 1e-12 * np.abs(field.values[mesh.triangles[where]]).max(axis=1)).all()
    if name == "gasEngineV.t":
        # Table 3.1 of the thesis counts 56 on the field subdivided once.
        assert 50 <= len(found) <= 70, Counter(point.kind for point in found)
