# SPDX-License-Identifier: GPL-3.0-or-later
"""Streamlines and pathlines from Python."""

import numpy as np
import pytest
from stormfield import native
from stormfield.readers.icosphere import icosphere


@pytest.fixture(scope="module")
def sphere():
    data = icosphere(5000)
    return native.TriangleMesh(data.vertices, data.triangles)


@pytest.fixture(scope="module")
def rotation(sphere):
    return native.VectorField.from_space(sphere, np.cross([0.0, 0.0, 1.0], sphere.vertices))


def seeds(mesh, count, seed=1):
    random = np.random.default_rng(seed)
    barycentric = random.dirichlet([1.0, 1.0, 1.0], count)
    return random.integers(0, mesh.face_count, count).astype(np.int32), barycentric


def split(traces):
    return [slice(a, b) for a, b in zip(traces.offsets[:-1], traces.offsets[1:], strict=True)]


def test_circles_of_a_rotating_sphere_close(sphere, rotation):
    faces, barycentric = seeds(sphere, 40)
    traces = native.streamlines(rotation, faces, barycentric, max_time=2 * np.pi)
    assert len(traces) == 40 and traces.reasons == ["time"] * 40
    start = sphere.positions(faces, barycentric)
    for i, part in enumerate(split(traces)):
        points, times = traces.points[part], traces.times[part]
        np.testing.assert_allclose(points[0], start[i], atol=1e-12)
        np.testing.assert_allclose(points[-1], start[i], atol=0.01)
        np.testing.assert_allclose(points[:, 2], start[i][2], atol=0.01)
        assert times[0] == 0.0 and times[-1] == 2 * np.pi and (np.diff(times) > 0).all()
        assert traces.lengths[i] == pytest.approx(2 * np.pi * np.hypot(*start[i][:2]), rel=0.01)


def test_points_lie_in_their_faces(sphere, rotation):
    traces = native.streamlines(rotation, *seeds(sphere, 10), max_length=1.0)
    np.testing.assert_allclose(sphere.positions(traces.faces, traces.barycentric), traces.points, atol=1e-12)
    assert traces.reasons == ["length"] * 10
    np.testing.assert_allclose(traces.lengths, 1.0)


def test_backward_returns(sphere, rotation):
    faces, barycentric = seeds(sphere, 10)
    there = native.streamlines(rotation, faces, barycentric, max_time=1.0, tolerance=1e-8)
    ends = there.offsets[1:] - 1
    back = native.streamlines(
        rotation, there.faces[ends], there.barycentric[ends], max_time=1.0, tolerance=1e-8, direction="backward"
    )
    np.testing.assert_allclose(back.points[back.offsets[1:] - 1], there.points[there.offsets[:-1]], atol=1e-6)


def test_pathlines_follow_lambda(sphere, rotation):
    values = np.stack([0.0 * rotation.values, rotation.values])
    field = native.ParameterizedField(sphere, np.array([0.0, 1.0]), values)
    faces, barycentric = seeds(sphere, 20)
    # Speed rises from 0 to 1 within a second, then stays: an angle of 1/2 after 1 s, 3/2 after 2 s.
    traces = native.pathlines(field, np.array([0.0, 1.0]), np.array([0.0, 1.0]), faces, barycentric, 0.0, 2.0)
    assert traces.reasons == ["time"] * 20
    start, end = traces.points[traces.offsets[:-1]], traces.points[traces.offsets[1:] - 1]
    turn = np.angle((end[:, 0] + 1j * end[:, 1]) / (start[:, 0] + 1j * start[:, 1]))
    np.testing.assert_allclose(turn, 1.5, atol=0.02)


def test_pathline_of_a_steady_field_is_its_streamline(sphere, rotation):
    field = native.ParameterizedField(sphere, np.array([0.0, 1.0]), np.stack([rotation.values] * 2))
    faces, barycentric = seeds(sphere, 20)
    durations = np.linspace(0.1, 2.0, 20)
    paths = native.pathlines(
        field, np.array([0.0, 1.0]), np.array([0.0, 1.0]), faces, barycentric, np.zeros(20), durations, speed=0.5
    )
    for i in range(20):
        line = native.streamlines(rotation, faces[i : i + 1], barycentric[i : i + 1], max_time=0.5 * durations[i])
        np.testing.assert_allclose(paths.points[paths.offsets[i + 1] - 1], line.points[-1], atol=1e-5)


def test_bad_input_is_named(sphere, rotation):
    faces, barycentric = seeds(sphere, 3)
    with pytest.raises(native.InputError, match="forward or backward"):
        native.streamlines(rotation, faces, barycentric, direction="up")
    with pytest.raises(native.InputError, match="stop or slide"):
        native.streamlines(rotation, faces, barycentric, boundary="bounce")
    with pytest.raises(native.InputError, match="float64"):
        native.streamlines(rotation, faces, barycentric.astype(np.float32))
    with pytest.raises(native.InputError, match="tolerance"):
        native.streamlines(rotation, faces, barycentric, tolerance=0.0)
    faces[1] = sphere.face_count
    with pytest.raises(native.InputError):
        native.streamlines(rotation, faces, barycentric)


def test_cancel(sphere, rotation):
    progress = native.Progress()
    progress.cancel()
    with pytest.raises(native.Cancelled):
        native.streamlines(rotation, *seeds(sphere, 3), max_time=1.0, progress=progress)


def test_streaklines_and_timelines(sphere, rotation):
    """In a field that does not change, every particle of a streakline lies on the circle of its seed."""
    field = native.ParameterizedField(sphere, np.array([0.0]), sphere.to_tangent(velocity(sphere))[None])
    track = np.array([0.0]), np.array([0.0])
    faces, barycentric = seeds(sphere, 5)
    at = np.array([0.5, 1.0])
    lines = native.start_streaklines(field, *track, faces, barycentric, 0.0, at, spacing=0.1).result()
    assert [line.time for line in lines] == [0.5, 1.0] and len(lines[1]) == 5
    start = sphere.positions(faces, barycentric)
    for i, part in enumerate(split(lines[1])):
        np.testing.assert_allclose(lines[1].points[part][:, 2], start[i][2], atol=0.01)
        np.testing.assert_allclose(lines[1].ages[part], 1.0 - lines[1].parameters[part])
        assert (np.linalg.norm(np.diff(lines[1].points[part], axis=0), axis=1) <= 0.1 + 1e-9).all()
    curve = (np.zeros(2, np.int32), np.array([[0.8, 0.1, 0.1], [0.1, 0.8, 0.1]]))
    fronts = native.start_timelines(field, *track, [curve], 0.0, at).result()
    traces = native.streamlines(rotation, *curve, max_time=1.0)
    np.testing.assert_allclose(fronts[1].points, traces.points[traces.offsets[1:] - 1], atol=1e-5)
    assert not fronts[1].torn.any()


def test_jobs_give_what_waiting_gives(sphere, rotation):
    job = native.start_streamlines(rotation, *seeds(sphere, 5), max_time=1.0)
    np.testing.assert_array_equal(
        job.result().points, native.streamlines(rotation, *seeds(sphere, 5), max_time=1.0).points
    )


def test_lines_refuse_bad_input(sphere):
    field = native.ParameterizedField(sphere, np.array([0.0]), sphere.to_tangent(velocity(sphere))[None])
    track = np.array([0.0]), np.array([0.0])
    with pytest.raises(native.InputError, match="increasing"):
        native.start_streaklines(field, *track, *seeds(sphere, 1), 0.0, np.array([1.0, 0.5])).result()
    with pytest.raises(native.InputError, match="larger spacing"):
        native.start_streaklines(
            field, *track, *seeds(sphere, 1), 0.0, np.array([1.0]), spacing=1e-4, max_particles=10
        ).result()


def velocity(sphere):
    return np.cross([0.0, 0.0, 1.0], sphere.vertices)
