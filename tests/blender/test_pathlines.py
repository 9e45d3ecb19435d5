# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator Flow Curves: paths of particles that follow the frames by Geometry Nodes alone."""

import bpy
import numpy as np
import pytest


@pytest.fixture
def vortex(ball, scene, put_field):
    """The ball turning around z once in 48 frames, as an attribute on its mesh."""
    scene.frame_start, scene.frame_end, scene.render.fps = 1, 25, 24
    rate = 2.0 * np.pi / 2.0
    put_field(ball, lambda p: rate * np.column_stack([-p[:, 1], p[:, 0], 0.0 * p[:, 0]]))
    return ball


def read(data, name, width=1, kind=np.float32):
    attribute = data.attributes[name].data
    values = np.empty(len(attribute) * width, kind)
    attribute.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def shown(obj, frame):
    """The curves as they are rendered at a frame."""
    bpy.context.scene.frame_set(frame)
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def test_pathlines_grow_to_where_the_particles_are(vortex):
    assert bpy.ops.stormfield.pathlines(kind="PATHLINE", count=12) == {"FINISHED"}
    curves = bpy.data.objects["Ball Pathlines"]
    assert curves.parent == vortex and len(curves.data.curves) == 12
    time, points = read(curves.data, "time"), read(curves.data, "position", 3)
    assert time.min() == pytest.approx(1 / 24) and time.max() == pytest.approx(25 / 24)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert np.allclose(read(curves.data, "speed"), np.pi * radius, atol=0.1)
    assert np.allclose(read(curves.data, "lam"), (time * 24 - 1) / 49, atol=1e-5)  # as the new field's λ is keyed
    half = shown(curves, 13)
    assert read(half, "time").max() == pytest.approx(13 / 24, abs=2e-4)
    assert len(half.curves) == 12
    # Half of the frames: a quarter of a turn for each.
    sizes = np.cumsum([len(curve.points) for curve in half.curves])
    now = read(half, "position", 3)
    for first, last in zip(np.r_[0, sizes[:-1]], sizes - 1, strict=True):
        a, b = now[first, :2], now[last, :2]
        assert abs(a @ b) < 0.05 * max(np.linalg.norm(a) ** 2, 0.05)
    assert len(shown(curves, 25).points) == len(curves.data.points)


def test_a_tail_leaves_the_last_seconds(vortex):
    bpy.ops.stormfield.pathlines(kind="PATHLINE", count=5, tail=0.25)
    time = read(shown(bpy.data.objects["Ball Pathlines"], 20), "time")
    assert time.min() >= 20 / 24 - 0.252 and time.max() == pytest.approx(20 / 24, abs=2e-4)


def test_the_four_curves_agree_where_the_field_stands_still(vortex):
    for kind in ("STREAMLINE", "PATHLINE", "STREAKLINE"):
        bpy.ops.stormfield.pathlines(kind=kind, count=4, seed=3)
    lines = {name: bpy.data.objects[f"Ball {name}"] for name in ("Streamlines", "Pathlines", "Streaklines")}
    stream = read(shown(lines["Streamlines"], 25), "position", 3)
    path = read(shown(lines["Pathlines"], 25), "position", 3)
    assert np.allclose(stream, path, atol=1e-6)
    streak = read(shown(lines["Streaklines"], 25), "position", 3)
    assert max(np.linalg.norm(path - p, axis=1).min() for p in streak) < 0.03


def test_streaklines_and_timelines_change_with_the_frame(vortex):
    for kind, name in (("STREAKLINE", "Streaklines"), ("TIMELINE", "Timelines")):
        assert bpy.ops.stormfield.pathlines(kind=kind, count=3) == {"FINISHED"}
        curves = bpy.data.objects[f"Ball {name}"]
        for frame in (5, 25, 40):
            data = shown(curves, frame)
            assert set(read(data, "frame", kind=np.int32)) == {min(frame, 25)}
            assert sorted(set(read(data, "seed", kind=np.int32))) == [0, 1, 2]
    assert set(read(shown(bpy.data.objects["Ball Timelines"], -3), "frame", kind=np.int32)) == {1}


def test_selected_vertices_are_the_seeds_and_running_again_updates(vortex):
    for vertex in vortex.data.vertices:
        vertex.select = vertex.index in (3, 40, 41)
    bpy.ops.stormfield.pathlines(kind="PATHLINE", seeds="SELECTED", radius=0.001)
    curves = bpy.data.objects["Ball Pathlines"]
    assert len(curves.data.curves) == 3
    points = read(curves.data, "position", 3)
    first = np.array([curve.first_point_index for curve in curves.data.curves])
    wanted = np.array([vortex.data.vertices[i].co for i in (3, 40, 41)])
    assert np.allclose(points[first], wanted, atol=0.01)
    count = len(bpy.data.objects)
    bpy.ops.stormfield.pathlines(kind="PATHLINE", count=7)
    assert len(bpy.data.objects) == count and len(curves.data.curves) == 7 and len(curves.modifiers) == 1


def test_faults_are_told(vortex, put_field, scene):
    for vertex in vortex.data.vertices:
        vertex.select = False
    with pytest.raises(RuntimeError, match="selected"):
        bpy.ops.stormfield.pathlines(seeds="SELECTED")
    put_field(vortex, np.zeros_like)
    with pytest.raises(RuntimeError, match="zero everywhere"):
        bpy.ops.stormfield.pathlines()
    scene.frame_end = scene.frame_start
    with pytest.raises(RuntimeError, match="single frame"):
        bpy.ops.stormfield.pathlines()


def test_a_solved_field_moves_particles_by_its_lambda(storms, scene, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "storms.blend"))
    storms.stormfield.lam = 0.0
    storms.keyframe_insert("stormfield.lam", frame=1)
    storms.stormfield.lam = 1.0
    storms.keyframe_insert("stormfield.lam", frame=50)
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert bpy.ops.stormfield.pathlines(count=10) == {"FINISHED"}
    data = bpy.data.objects["Ball Pathlines"].data
    lam = read(data, "lam")
    assert lam.min() == pytest.approx(0.0, abs=1e-6) and lam.max() == pytest.approx(1.0, abs=1e-6)
