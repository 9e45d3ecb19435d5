# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator Evenly Spaced Streamlines: one Curves object with radius and attributes, updated in place."""

import bpy
import numpy as np
import pytest


@pytest.fixture
def vortex(ball, put_field):
    """The ball turning around z, as an attribute on its mesh."""
    put_field(ball, lambda p: np.column_stack([-p[:, 1], p[:, 0], 0.0 * p[:, 0]]))
    return ball


def read(obj, name, width=1):
    data = obj.data.attributes[name].data
    values = np.empty(len(data) * width, np.float32)
    data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def test_it_draws_closed_lines_around_a_vortex(vortex):
    assert bpy.ops.stormfield.streamlines(density=0.05) == {"FINISHED"}
    curves = bpy.data.objects["Ball Streamlines"]
    assert curves.parent == vortex
    assert read(curves, "cyclic").all()
    points = read(curves, "position", 3)
    assert 1.0 < np.linalg.norm(points, axis=1).min() < np.linalg.norm(points, axis=1).max() < 1.05
    assert np.allclose(read(curves, "speed"), np.hypot(points[:, 0], points[:, 1]), atol=0.06)
    assert (read(curves, "radius") > 0.0).all()
    assert len(read(curves, "length")) == len(curves.data.curves)


def test_running_again_updates_in_place(vortex):
    bpy.ops.stormfield.streamlines(density=0.05)
    count = len(bpy.data.objects)
    few = len(bpy.data.objects["Ball Streamlines"].data.curves)
    bpy.ops.stormfield.streamlines(density=0.03)
    assert len(bpy.data.objects) == count
    assert len(bpy.data.objects["Ball Streamlines"].data.curves) > few
    assert len(bpy.data.hair_curves) == 1


def test_undo_brings_the_earlier_lines_back(vortex):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.streamlines(density=0.05)
    bpy.ops.ed.undo_push(message="wide")
    wide = len(bpy.data.objects["Ball Streamlines"].data.curves)
    bpy.ops.stormfield.streamlines(density=0.03)
    bpy.ops.ed.undo_push(message="narrow")
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Ball Streamlines"].data.curves) == wide
    bpy.ops.ed.undo()
    assert "Ball Streamlines" not in bpy.data.objects


def test_arrows_are_curves_of_three_points_and_taper_can_be_off(vortex, put_field):
    put_field(vortex, lambda p: np.column_stack([1.0 + 0.0 * p[:, 0], 0.2 * p[:, 0], -p[:, 1]]))
    bpy.ops.stormfield.streamlines(density=0.04, arrows=True, taper=0.0)
    curves = bpy.data.objects["Ball Streamlines"]
    arrow = read(curves, "arrow").astype(bool)
    assert 0 < arrow.sum() < len(arrow)
    sizes = np.array([len(curve.points) for curve in curves.data.curves])
    assert (sizes[arrow] == 3).all()
    barbs = read(curves, "position", 3)[np.repeat(arrow, sizes)].reshape(-1, 3, 3)
    forward = barbs[:, 1] - 0.5 * (barbs[:, 0] + barbs[:, 2])
    tips = barbs[:, 1]
    flow = np.column_stack([1.0 + 0.0 * tips[:, 0], 0.2 * tips[:, 0], -tips[:, 1]])
    flow -= (flow * tips).sum(axis=1, keepdims=True) * tips / (tips**2).sum(axis=1, keepdims=True)
    cosine = (forward * flow).sum(axis=1) / np.linalg.norm(forward, axis=1) / np.linalg.norm(flow, axis=1)
    assert (cosine > 0.8).all()
    lines = np.repeat(~arrow, sizes)
    radius = read(curves, "radius")
    assert np.allclose(radius[lines], radius[lines][0])


def test_a_field_of_zeros_is_reported(vortex, put_field):
    put_field(vortex, np.zeros_like)
    with pytest.raises(RuntimeError, match="zero everywhere"):
        bpy.ops.stormfield.streamlines()


def test_it_needs_a_field(ball):
    assert not bpy.ops.stormfield.streamlines.poll()


def test_lines_come_pale_once_and_keep_the_artists_material(vortex):
    bpy.ops.stormfield.streamlines(density=0.05)
    curves = bpy.data.objects["Ball Streamlines"]
    (pale,) = curves.data.materials
    assert min(pale.diffuse_color[:3]) > 0.6
    curves.data.materials[0] = bpy.data.materials.new("own")
    bpy.ops.stormfield.streamlines(density=0.05)
    assert [material.name for material in curves.data.materials] == ["own"]
    curves.data.materials.clear()
    bpy.ops.stormfield.streamlines(density=0.05)
    assert not curves.data.materials
