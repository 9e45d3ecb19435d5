# SPDX-License-Identifier: GPL-3.0-or-later
"""Analyses in steps: meshes are built on other threads, and who stops an analysis never waits for it."""

import time

import numpy as np
import pytest
from stormfield import native
from stormfield.analysis.steps import ecg_steps, surface_steps
from stormfield.analysis.streamlines import Settings, streamline_steps
from stormfield.model.mesh_data import MeshData
from stormfield.readers.icosphere import icosphere
from stormfield.work import run


@pytest.fixture(scope="module")
def ball():
    data = icosphere(81920)
    return MeshData(data.vertices, data.triangles)


def test_a_mesh_built_in_steps_is_the_same(ball):
    plain = native.TriangleMesh(ball.vertices, ball.triangles)
    built = run(surface_steps(ball))
    np.testing.assert_array_equal(built.vertices, plain.vertices)
    np.testing.assert_array_equal(built.triangles, plain.triangles)
    assert built.mean_edge_length == plain.mean_edge_length


def test_faults_of_a_mesh_come_out_of_its_job():
    with pytest.raises(native.MeshError, match="face"):
        native.start_triangle_mesh(np.eye(3), np.array([[0, 1, 7]], np.int32)).result()
    with pytest.raises(native.InputError, match="triangles"):
        native.start_triangle_mesh(np.eye(3), np.zeros((1, 2), np.int32))


def test_a_cancelled_mesh_raises_cancelled(ball):
    job = native.start_triangle_mesh(ball.vertices, ball.triangles)
    job.cancel()
    with pytest.raises(native.Cancelled):
        job.result()


@pytest.mark.parametrize("seconds", [0.0, 0.05, 0.2])
@pytest.mark.parametrize("what", ["ecg", "streamlines"])
def test_closing_an_analysis_waits_for_nothing(ball, what, seconds, ending):
    values = np.cross(ball.vertices, [0.2, 0.1, 1.0])
    settings = Settings(density=0.005)
    steps = ecg_steps(ball, values, 0.0) if what == "ecg" else streamline_steps(ball, values, settings)
    until = time.monotonic() + seconds
    step = next(steps, None)
    while step is not None and time.monotonic() < until:
        time.sleep(0.01)
        step = next(steps, None)
    began = time.thread_time()
    steps.close()
    assert time.thread_time() - began < 0.05  # of the processor
    assert step is None or not step.waiting or ending  # what was waited for went on to its end alone
