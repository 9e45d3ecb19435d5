# SPDX-License-Identifier: GPL-3.0-or-later
"""Evenly spaced streamlines from Python: arrays that fit, given curves, faults, and a stop within 0.1 s."""

import time

import numpy as np
import pytest
from stormfield import native
from stormfield.analysis.streamlines import Settings, streamline_steps
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.readers.icosphere import icosphere
from stormfield.work import run


def turning(points):
    return np.column_stack([-points[:, 1], points[:, 0], 0.0 * points[:, 0]])


@pytest.fixture(scope="module")
def sphere():
    data = icosphere(5120)
    return native.TriangleMesh(data.vertices, data.triangles)


@pytest.fixture(scope="module")
def field(sphere):
    return native.VectorField.from_space(sphere, turning(sphere.vertices))


def test_arrays_fit_together(sphere, field):
    lines = native.start_evenly_spaced_streamlines(field, 0.2).result()
    count = len(lines.points)
    assert lines.offsets[0] == 0 and lines.offsets[-1] == count and len(lines.offsets) == len(lines) + 1
    for name in ("faces", "arc", "speed", "taper"):
        assert getattr(lines, name).shape == (count,)
    for name in ("closed", "given", "roles"):
        assert getattr(lines, name).shape == (len(lines),)
    np.testing.assert_allclose(sphere.positions(lines.faces, lines.barycentric), lines.points, atol=1e-12)
    np.testing.assert_allclose(lines.speed, np.hypot(lines.points[:, 0], lines.points[:, 1]), atol=0.01)
    assert lines.closed.all()
    assert len(lines.gaps) == 0 and lines.quiet_area == 0.0


def test_a_given_curve_is_the_first_line_and_has_room(sphere, field):
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    equator = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(200)])
    faces, barycentric, _ = sphere.closest_points(equator)
    curve = (faces, barycentric, True, False)
    lines = native.start_evenly_spaced_streamlines(field, 0.2, topology=False, curves=[curve]).result()
    assert lines.given[0] == 0 and lines.roles[0] == 1 and lines.closed[0]
    others = lines.points[lines.offsets[1] :]
    assert np.abs(others[:, 2]).min() > 0.095


def test_faults_name_what_is_wrong(sphere, field):
    with pytest.raises(native.InputError, match="give at least"):
        native.start_evenly_spaced_streamlines(field, 0.0).result()
    with pytest.raises(native.InputError, match="given curve"):
        native.start_evenly_spaced_streamlines(field, 0.1, curves=[(1, 2)])
    with pytest.raises(native.InputError, match="faces"):
        curve = (np.array([99999], np.int32), np.array([[1.0, 0.0, 0.0]]), False, False)
        native.start_evenly_spaced_streamlines(field, 0.1, curves=[curve])


@pytest.mark.parametrize("distance", [0.004, 0.5])
def test_cancelling_stops_soon(sphere, field, distance):
    job = native.start_evenly_spaced_streamlines(field, distance)
    time.sleep(0.01)
    job.cancel()
    done = job.fraction
    with pytest.raises(native.Cancelled):
        job.result()
    assert job.fraction <= done + 0.3  # of the whole


def test_settings_shape_the_drawing():
    data = icosphere(1280)
    mesh = MeshData(data.vertices, data.triangles)
    values = np.column_stack([np.ones(len(mesh.vertices)), 0.3 * mesh.vertices[:, 0], -mesh.vertices[:, 1]])
    plain = run(streamline_steps(mesh, values, Settings(density=0.05, taper=0.0)))
    fine = run(streamline_steps(mesh, values, Settings(density=0.03, arrows=True)))
    assert fine.lines > plain.lines == len(plain.curves)
    radius = np.concatenate(plain.radii)
    np.testing.assert_allclose(radius, radius[0])
    assert len(fine.curves) > fine.lines
    assert fine.curve_attributes["arrow"].sum() == len(fine.curves) - fine.lines
    for key in ("speed", "distance"):
        assert [len(v) for v in fine.attributes[key]] == [len(c) for c in fine.curves]
    with pytest.raises(InputError, match="zero everywhere"):
        run(streamline_steps(mesh, 0.0 * values, Settings()))
