# SPDX-License-Identifier: GPL-3.0-or-later
"""The λ that is seen is what is solved, baked, marked and rendered, whatever it comes from."""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from fields_seen import key_lambda, moving, off, seen, seen_without_addon
from stormfield import compat

pytestmark = pytest.mark.usefixtures("native")
FRAMES = (1, 4, 6.25, 7.5, 9, 13, 17)


@pytest.fixture
def solved(storms, scene):
    scene.frame_end = 17
    moving(storms)
    storms.animation_data_clear()
    storms.stormfield.lam = 0.25
    bpy.ops.stormfield.solve()
    yield storms
    forget_scripts()


def forget_scripts():
    for handlers in (bpy.app.handlers.frame_change_pre, bpy.app.handlers.frame_change_post):
        handlers[:] = [function for function in handlers if function.__module__.startswith("stormfield")]


def curve_of(obj):
    return compat.find_fcurve(obj, "stormfield.lam")


def keys(obj):
    key_lambda(obj, (1, 0.0), (17, 1.0))


def close_keys(obj):
    key_lambda(obj, (1, 0.1), (8.998, 0.1), (9.002, 0.9), (17, 0.9))


def bezier_keys(obj):
    key_lambda(obj, (3, 0.0), (12, 1.0))
    for key in curve_of(obj).keyframe_points:
        key.interpolation = "BEZIER"
    curve_of(obj).update()


def cycles(obj):
    key_lambda(obj, (1, 0.0), (5, 1.0))
    modifier = curve_of(obj).modifiers.new("CYCLES")
    modifier.mode_after = "MIRROR"


def noise(obj):
    key_lambda(obj, (1, 0.3), (17, 0.7))
    modifier = curve_of(obj).modifiers.new("NOISE")
    modifier.strength, modifier.scale, modifier.phase = 0.3, 4.0, 1.5


def limits_and_steps(obj):
    key_lambda(obj, (1, 0.0), (17, 1.0))
    stepped = curve_of(obj).modifiers.new("STEPPED")
    stepped.frame_step, stepped.frame_offset = 3.0, 1.0
    limits = curve_of(obj).modifiers.new("LIMITS")
    limits.use_min_y, limits.min_y, limits.use_max_y, limits.max_y = True, 0.2, True, 0.6


def envelope(obj):
    key_lambda(obj, (1, 0.0), (17, 1.0))
    modifier = curve_of(obj).modifiers.new("ENVELOPE")
    modifier.reference_value, modifier.default_min, modifier.default_max = 0.5, -0.5, 0.5
    for frame, low, high in ((1, -0.5, 0.5), (17, -1.0, 1.2)):
        point = modifier.control_points.add(frame)
        point.min, point.max = low, high


def generator(obj):
    key_lambda(obj, (1, 0.0), (17, 1.0))
    modifier = curve_of(obj).modifiers.new("GENERATOR")
    modifier.use_additive, modifier.poly_order, modifier.coefficients = False, 1, (0.1, 0.04)


def controller():
    empty = bpy.data.objects.new("Controller", None)
    bpy.context.scene.collection.objects.link(empty)
    empty["storm"] = 0.0
    for frame, value in ((1, 0.0), (17, 2.0)):
        empty["storm"] = value
        empty.keyframe_insert('["storm"]', frame=frame)
    for key in compat.find_fcurve(empty, '["storm"]').keyframe_points:
        key.interpolation = "LINEAR"
    return empty


def drive(obj, target, path, expression):
    curve = obj.driver_add("stormfield.lam")
    curve.driver.type = "SCRIPTED"
    variable = curve.driver.variables.new()
    variable.name = "x"
    variable.targets[0].id, variable.targets[0].data_path = target, path
    curve.driver.expression = expression
    return curve


def slider(obj):
    drive(obj, controller(), '["storm"]', "x / 2")


def average_of_a_place(obj):
    empty = bpy.data.objects.new("Height", None)
    bpy.context.scene.collection.objects.link(empty)
    for frame, height in ((1, 0.0), (17, 1.0)):
        empty.location.z = height
        empty.keyframe_insert("location", frame=frame)
    curve = obj.driver_add("stormfield.lam")
    curve.driver.type = "AVERAGE"
    variable = curve.driver.variables.new()
    variable.type = "TRANSFORMS"
    variable.targets[0].id, variable.targets[0].transform_type = empty, "LOC_Z"


def frame_driver(obj):
    curve = obj.driver_add("stormfield.lam")
    curve.driver.type = "SCRIPTED"
    curve.driver.expression = "(frame - 1) / 16"


def own_setting(obj):
    obj["storm"] = 0.0
    for frame, value in ((1, 0.0), (17, 1.0)):
        obj["storm"] = value
        obj.keyframe_insert('["storm"]', frame=frame)
    drive(obj, obj, '["storm"]', "x")


def another_field(obj):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    leader = bpy.context.object
    leader.stormfield.enabled = True
    key_lambda(leader, (1, 1.0), (17, 0.0))
    drive(obj, leader, "stormfield.lam", "x")
    bpy.context.view_layer.objects.active = obj


def nla(obj):
    keys(obj)
    action, slot = obj.animation_data.action, getattr(obj.animation_data, "action_slot", None)
    track = obj.animation_data.nla_tracks.new()
    strip = track.strips.new("Storm", 4, action)
    if slot is not None:
        strip.action_slot = slot
    strip.scale, strip.use_reverse = 0.5, True
    obj.animation_data.action = None


def script_before(obj):
    def set_lambda(scene, *_):
        bpy.data.objects["Ball"].stormfield.lam = abs(math.sin(scene.frame_current_final / 5.0))

    set_lambda.__module__ = "artist"
    bpy.app.handlers.frame_change_pre.append(set_lambda)


def script_after(obj):
    def set_lambda(scene, *_):
        bpy.data.objects["Ball"].stormfield.lam = (scene.frame_current_final - 1) / 16

    set_lambda.__module__ = "artist"
    bpy.app.handlers.frame_change_post.append(set_lambda)


def constant(obj):
    obj.stormfield.lam = 0.6


SOURCES = {
    each.__name__: each
    for each in (
        *(keys, close_keys, bezier_keys, cycles, noise, limits_and_steps, envelope, generator, slider),
        *(average_of_a_place, frame_driver, own_setting, another_field, nla, script_before, script_after, constant),
    )
}


def seen_lambda(obj, frame):
    bpy.context.scene.frame_set(math.floor(frame), subframe=frame % 1)
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).stormfield.lam


@pytest.mark.parametrize("source", SOURCES)
def test_lambda_at_frames_is_what_is_seen(solved, scene, source):
    from stormfield.scene.read.lambda_seen import lambda_at_frames

    SOURCES[source](solved)
    scene.frame_set(3)
    found = lambda_at_frames(bpy.context, solved, FRAMES)
    assert scene.frame_current == 3 and len(bpy.data.scenes) == 1
    expected = [seen_lambda(solved, frame) for frame in FRAMES]
    assert np.allclose(found, expected, atol=1e-6)
    assert source == "constant" or np.ptp(expected) > 0.2


@pytest.mark.parametrize("source", SOURCES)
def test_a_file_plays_the_same_without_the_addon(solved, scene, tmp_path, source):
    SOURCES[source](solved)
    path = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    assert len(bpy.data.scenes) == 1
    expected = [seen(solved, frame) for frame in FRAMES]
    without = seen_without_addon(path, "Ball", FRAMES, tmp_path)
    # Between frames, samples are joined by straight lines.
    assert max(off(a, b) for a, b in zip(without, expected, strict=True)) < 5e-3
    forget_scripts()
    bpy.ops.wm.open_mainfile(filepath=str(path))


@pytest.mark.parametrize("source", ["slider", "nla", "script_after", "cycles"])
def test_bakes_use_the_lambda_that_is_seen(solved, scene, source):
    from stormfield.scene.read.bake_task import read_bake_task

    SOURCES[source](solved)
    task = read_bake_task(bpy.context, solved, Path())
    expected = [seen_lambda(solved, frame) for frame in range(1, 18)]
    assert np.allclose(task.lambdas, expected, atol=1e-6)


@pytest.mark.parametrize("source", ["keys", "slider", "nla"])
def test_time_stretching_counts(solved, scene, source):
    from stormfield.scene.read.lambda_seen import lambda_at_frames, passages

    SOURCES[source](solved)
    scene.render.frame_map_old, scene.render.frame_map_new = 100, 200
    frames = (1, 5, 10, 15.5)
    found = lambda_at_frames(bpy.context, solved, frames)
    assert np.allclose(found, [seen_lambda(solved, frame) for frame in frames], atol=1e-6)
    if source == "keys":
        assert passages(bpy.context, solved, [0.5]) == [[(18, True)]]


@pytest.mark.parametrize("source", ["keys", "slider", "frame_driver"])
def test_markers_stand_where_the_seen_lambda_passes(solved, source):
    from stormfield.scene.read.lambda_seen import passages

    SOURCES[source](solved)
    assert passages(bpy.context, solved, [0.5, 0.25]) == [[(9, True)], [(5, True)]]


@pytest.mark.parametrize("source", ["keys", "slider", "nla"])
def test_a_solve_reads_the_seen_rate(solved, scene, source):
    from stormfield.scene.read.lambda_seen import lambda_per_second

    SOURCES[source](solved)
    expected = 24 / 16 if source != "nla" else 24 / 8
    assert lambda_per_second(bpy.context, solved) == pytest.approx(expected, rel=0.1)


def test_animated_elements_are_read_over_a_driven_lambda(solved, scene):
    from stormfield.scene.read.design import read_design

    slider(solved)
    empty = solved.stormfield.elements[0].source
    for frame, x in ((1, -1.0), (17, 1.0)):
        empty.location = (x, 0.2, 0.0)
        empty.keyframe_insert("location", frame=frame)
    solved.stormfield.elements[0].from_animation = True
    _mesh, design = read_design(bpy.context, solved)
    assert len(design.elements[0].points) == 17 and design.elements[0].lam[-1] == pytest.approx(1.0)


def test_a_script_that_sets_lambda_is_seen_at_once(solved):
    before = seen(solved)
    solved.stormfield.lam = 1.0
    assert off(seen(solved), before) > 0.2


def test_saving_leaves_the_open_file_as_it_was(solved, scene, tmp_path):
    curve = drive(solved, controller(), '["storm"]', "x / 2")
    scene.frame_set(5)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert scene.frame_current == 5
    curve.driver.expression = "1 - x / 2"
    bpy.context.view_layer.update()
    from stormfield.scene.read.current_field import cache_of
    from stormfield.scene.read.mesh import read_mesh

    cache = cache_of(solved, read_mesh(solved))
    for frame in (1, 9):
        assert off(seen(solved, frame), cache.at(1 - (frame - 1) / 16)["sf_advection"]) < 1e-5
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    solved = bpy.data.objects["Ball"]
    solved.driver_remove("stormfield.lam")
    solved.stormfield.lam = 0.5
    assert off(seen(solved), cache.at(0.5)["sf_advection"]) < 1e-5


def test_what_is_sampled_is_said(solved, tmp_path, capsys):
    nla(solved)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert "λ of 'Ball' comes from NLA strips" in capsys.readouterr().out


@pytest.mark.parametrize("new", [100, 200])
def test_flowing_texture_is_that_of_the_frame_under_time_stretching(solved, scene, tmp_path, new):
    from stormfield.cache.field_cache import open_cache
    from stormfield.scene.read.attached import FRAMES as FLOW
    from stormfield.scene.read.attached import attached_folder

    keys(solved)
    scene.frame_end, solved.stormfield.bake.period = 9, 6
    scene.render.frame_map_new = new
    bpy.ops.stormfield.bake()
    cache = open_cache(attached_folder(solved, FLOW))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    for frame in (2, 7, 9):
        assert np.abs(seen(solved, frame, "sf_phase_a") - cache.sample(frame - 1)["sf_phase_a"]).max() < 1e-5


def test_the_command_line_bakes_the_lambda_that_is_seen(solved, scene, tmp_path, capfd):
    import json

    from stormfield.cli import main

    slider(solved)
    expected = [seen_lambda(solved, frame) for frame in range(1, 18)]
    solved.data.uv_layers.new(name="Map")
    solved.stormfield.bake.resolution = "256"
    path = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    assert main(["bake", str(path), "--targets", "exr"]) == 0
    assert "λ of 'Ball' comes from a driver" in capfd.readouterr().err
    (manifest,) = path.parent.glob("stormfield_cache/Ball/exr-*/manifest.json")
    assert np.allclose(json.loads(manifest.read_text())["settings"]["from"]["lambdas"], expected, atol=1e-6)


@pytest.mark.parametrize("source", ["keys", "nla", "slider"])
def test_one_animation_alone_moves_the_cache_at_a_time(solved, scene, tmp_path, source):
    """Beside a driver that is invalid, Blender's threads let an F-curve show an earlier frame now and then."""
    SOURCES[source](solved)
    cache_file = solved.modifiers[0].cache_file

    def animations(data):
        curve = compat.find_fcurve(data, "frame")
        drivers = [each for each in data.animation_data.drivers if each.data_path == "frame"]
        return curve is not None, [each.driver.variables[0].targets[0].data_path for each in drivers]

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"), copy=True)
    assert animations(cache_file) == (False, ["stormfield.lam"])
    with bpy.data.libraries.load(str(tmp_path / "shot.blend"), link=True) as (available, wanted):
        wanted.cache_files = available.cache_files
    (linked,) = (each for each in bpy.data.cache_files if each.library is not None)
    assert animations(linked) == ((False, ['["storm"]']) if source == "slider" else (True, []))
