# SPDX-License-Identifier: GPL-3.0-or-later
"""Advected coordinates and stream functions."""

from types import SimpleNamespace

import numpy as np
import pytest
from stormfield import native
from stormfield.bake.targets.frames import BLEND, PHASE_A, PHASE_B, FlowCoordinates
from stormfield.readers.icosphere import icosphere

FRAMES = np.arange(1, 61)


@pytest.fixture(scope="module")
def sphere():
    data = icosphere(2000)
    return native.TriangleMesh(data.vertices, data.triangles)


@pytest.fixture(scope="module")
def field(sphere):
    """A rotation whose axis turns from z to x as λ goes from 0 to 1."""
    axes = [[np.cos(a), 0.0, np.sin(a)] for a in np.linspace(np.pi / 2, 0.0, 5)]
    values = np.stack([sphere.to_tangent(np.cross(axis, sphere.vertices)) for axis in axes])
    return native.ParameterizedField(sphere, np.linspace(0.0, 1.0, 5), values)


def task(frames=FRAMES, period=24, speed=1.0):
    lambdas = np.clip((np.asarray(frames) - 1) / 59.0, 0.0, 1.0)
    flow = SimpleNamespace(period=period, speed=speed)
    return SimpleNamespace(frames=tuple(frames), lambdas=tuple(lambdas), frames_per_second=24.0, flow=flow)


def attributes_at(coordinates, index):
    return coordinates.attributes_of(coordinates.start(index).result())


def test_frames_have_the_attributes_of_the_cache(sphere, field):
    attributes = attributes_at(FlowCoordinates(field, task()), 30)
    n = sphere.vertex_count
    assert {name: (a.shape, a.dtype) for name, a in attributes.items()} == {
        PHASE_A: ((n, 3), np.float32),
        PHASE_B: ((n, 3), np.float32),
        BLEND: ((n,), np.float32),
    }
    assert attributes[BLEND].min() >= 0.0 and attributes[BLEND].max() <= 1.0


def test_any_part_of_a_bake_gives_the_same_bytes(field):
    one, other = FlowCoordinates(field, task()), FlowCoordinates(field, task())
    attributes_at(other, 3)
    for name, values in attributes_at(one, 41).items():
        assert values.tobytes() == attributes_at(other, 41)[name].tobytes()


def test_coordinates_are_carried_back_by_the_rotation(sphere):
    values = np.stack([sphere.to_tangent(np.cross([0.0, 0.0, 1.0], sphere.vertices))])
    steady = native.ParameterizedField(sphere, np.array([0.0]), values)
    coordinates = native.AdvectedCoordinates(
        steady, np.array([0.0]), np.array([0.0]), period=40.0, speed=0.5, renewal=0.0, frames_per_second=20.0
    )
    phase_a, phase_b, blend = coordinates.frame(10.0)
    for phase, shift in ((phase_a, 0.0), (phase_b, 0.5)):
        age = (10.0 / 40.0 + coordinates.offsets + shift) % 1.0
        turned = (phase[:, 0] + 1j * phase[:, 1]) * np.exp(0.5j * age * 40.0 / 20.0)
        np.testing.assert_allclose(turned, sphere.vertices[:, 0] + 1j * sphere.vertices[:, 1], atol=0.02)
        np.testing.assert_allclose(phase[:, 2], sphere.vertices[:, 2], atol=0.02)
    assert blend.min() >= 0.0 and blend.max() <= 1.0


def test_offsets_of_ones_own(sphere, field):
    lam = np.array([0.0, 1.0])
    flat = native.AdvectedCoordinates(field, np.array([1.0, 60.0]), lam, offsets=np.zeros(sphere.vertex_count))
    _, _, blend = flat.frame(12.0)
    assert np.ptp(blend) == 0.0
    rough = np.random.default_rng(1).random(sphere.vertex_count)
    with pytest.raises(native.InputError, match="dead zone"):
        native.AdvectedCoordinates(field, np.array([1.0, 60.0]), lam, offsets=rough)


def test_error_is_stated(field):
    error = FlowCoordinates(field, task()).error(50)
    assert error["mean"] < 1e-3 and error["mean"] < error["mean_between"] < 0.2


def test_a_frame_can_be_watched_and_cancelled(field):
    flow = FlowCoordinates(field, task())
    job = flow.start(5)
    assert set(flow.attributes_of(job.result())) == {PHASE_A, PHASE_B, BLEND} and job.done and job.fraction == 1.0
    many = flow._coordinates.start_frames([float(f) for f in range(1000)])
    many.cancel()
    with pytest.raises(native.Cancelled):
        many.result()


def test_stream_function_of_a_rotation_is_height_along_its_axis(sphere, field):
    psi = native.stream_functions(field)
    assert psi.shape == (5, sphere.vertex_count) and psi.dtype == np.float64
    np.testing.assert_allclose(psi[0], sphere.vertices[:, 2], atol=0.02)
    np.testing.assert_allclose(psi[-1], sphere.vertices[:, 0], atol=0.02)
    np.testing.assert_array_equal(native.start_stream_functions(field).result(), psi)


def test_attributes_of_samples_are_those_of_both_fields(sphere, field):
    found = native.start_field_attributes(field, field, 1, 3).result()
    n, vectors = sphere.vertex_count, field.sample(2).to_space()
    assert found.advection.shape == found.orientation.shape == (3, n, 3) and found.rotation.shape == (3, n)
    assert all(values.dtype == np.float32 for values in (found.advection, found.speed, found.stream, found.rotation))
    np.testing.assert_array_equal(found.advection[1], vectors.astype(np.float32))
    np.testing.assert_array_equal(found.stream, native.stream_functions(field)[1:4].astype(np.float32))
    np.testing.assert_allclose(found.speed[1], np.linalg.norm(vectors, axis=1), rtol=1e-6)
    other = native.ParameterizedField(sphere, field.lambdas, 2.0 * field.values)
    both = native.field_attributes(other, field, 1, 3)
    np.testing.assert_array_equal(both.orientation, 2.0 * found.advection)
    np.testing.assert_array_equal(both.advection, found.advection)
    assert not both.stream.flags.writeable


def test_rotation_is_twice_the_angular_speed_about_the_axis_of_the_surface(sphere, field):
    found = native.field_attributes(field, field, 0, 1).rotation[0]
    np.testing.assert_allclose(found, 2.0 * sphere.vertices[:, 2], atol=0.05)


def test_samples_that_do_not_exist_have_no_attributes(sphere, field):
    with pytest.raises(native.InputError, match="samples 4 to 5 do not exist; the field has samples 0 to 4"):
        native.start_field_attributes(field, field, 4, 2)
    short = native.ParameterizedField(sphere, field.lambdas[:3], field.values[:3])
    with pytest.raises(native.InputError, match="other samples"):
        native.start_field_attributes(short, field, 0, 1)


def test_a_factor_is_made_once_for_a_mesh(sphere, field):
    assert native.start_stream_factor(sphere).result() is None
    again = native.start_stream_factor(sphere)
    assert again.wait(0.1) and again.result() is None


def test_stream_functions_change_continuously_with_lambda(sphere, field):
    half = native.ParameterizedField(sphere, np.array([0.0]), field.at(0.375).values[None])
    psi = native.stream_functions(field)
    np.testing.assert_allclose(native.stream_functions(half)[0], 0.5 * (psi[1] + psi[2]), atol=1e-12)
