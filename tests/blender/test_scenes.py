# SPDX-License-Identifier: GPL-3.0-or-later
"""One object in two scenes whose frame rates, frames or time differ: each scene shows what it says."""

import subprocess
import sys

import bpy
import numpy as np
import pytest
from fields_seen import moving, off

SEEN = """
import os, sys
import bpy, numpy as np
blend, out = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=blend)
assert not hasattr(bpy.types.Object, "stormfield")
found = {}
for scene in bpy.data.scenes:
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer):
        scene.frame_set(5)
        graph = layer.depsgraph
        graph.update()
        mesh = bpy.data.objects["Ball"].evaluated_get(graph).data
        values = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.attributes["sf_phase_a"].data.foreach_get("vector", values)
        found[scene.name] = values.reshape(-1, 3)
np.savez(out, **found)
os._exit(0)
"""


@pytest.fixture
def fast(scene):
    scene.name, scene.frame_end, scene.render.fps = "Fast", 9, 48
    return scene


@pytest.fixture
def slow(fast, storms):
    """Another scene that holds the object too, with half as many frames a second."""
    moving(storms)
    bpy.ops.stormfield.solve()
    storms.stormfield.bake.period = 6
    other = bpy.data.scenes.new("Slow")
    other.frame_end, other.render.fps = 9, 12
    for obj in fast.objects:
        other.collection.objects.link(obj)
    return other


def seen_in(scene, obj, frame=5, name="sf_phase_a"):
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer):
        scene.frame_set(frame)
        layer.depsgraph.update()
        mesh = obj.evaluated_get(layer.depsgraph).data
        values = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.attributes[name].data.foreach_get("vector", values)
        return values.reshape(-1, 3)


def bake_in(scene, obj):
    """What the bake of a scene holds of frame 5."""
    from stormfield.cache.field_cache import open_cache
    from stormfield.scene.read.attached import FRAMES, attached_folder

    bpy.context.window.scene = scene
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.stormfield.bake() == {"FINISHED"}
    return open_cache(attached_folder(obj, FRAMES)).at(5)["sf_phase_a"]


def flows(obj):
    from stormfield.scene.read.attached import FRAMES, modifiers_of

    return len(modifiers_of(obj, FRAMES))


def test_each_scene_shows_its_own_bake(storms, fast, slow, tmp_path):
    first, second = bake_in(fast, storms), bake_in(slow, storms)
    assert off(first, second) > 0.01
    for _twice in range(2):
        assert off(seen_in(fast, storms), first) < 1e-5
        assert off(seen_in(slow, storms), second) < 1e-5
    again = bake_in(fast, storms)
    assert off(again, first) == 0.0
    assert flows(storms) == 2
    path, out = tmp_path / "two.blend", tmp_path / "seen.npz"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    script = tmp_path / "seen.py"
    script.write_text(SEEN)
    done = subprocess.run([sys.executable, script, path, out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    without = np.load(out)
    assert off(without["Fast"], first) < 1e-5 and off(without["Slow"], second) < 1e-5


def test_a_scene_without_a_bake_of_its_own_shows_the_first(storms, fast, slow):
    first = bake_in(fast, storms)
    assert off(seen_in(slow, storms), first) < 1e-5
    bake_in(slow, storms)
    third = bpy.data.scenes.new("Third")
    third.collection.objects.link(storms)
    assert off(seen_in(third, storms), first) < 1e-5


def test_a_copied_scene_shows_what_the_first_does_until_it_is_baked(storms, fast):
    moving(storms)
    storms.stormfield.bake.period = 6
    bpy.ops.stormfield.solve()
    first = bake_in(fast, storms)
    bpy.ops.scene.new(type="LINK_COPY")
    copy = bpy.context.scene
    copy.name, copy.render.fps = "Copy", 12
    assert off(seen_in(copy, storms), first) < 1e-5
    second = bake_in(copy, storms)
    assert off(first, second) > 0.01
    assert off(seen_in(copy, storms), second) < 1e-5
    assert off(seen_in(fast, storms), first) < 1e-5


def test_the_flow_of_a_scene_that_is_gone_is_taken_over(storms, fast, slow):
    bake_in(fast, storms)
    bake_in(slow, storms)
    bpy.context.window.scene = fast
    bpy.data.scenes.remove(slow)
    third = bpy.data.scenes.new("Third")
    third.frame_end, third.render.fps = 9, 24
    third.collection.objects.link(storms)
    values = bake_in(third, storms)
    assert flows(storms) == 2
    assert off(seen_in(third, storms), values) < 1e-5


def test_one_scene_needs_no_drivers(storms, fast):
    bpy.ops.stormfield.solve()
    bake_in(fast, storms)
    assert not any("modifiers" in curve.data_path for curve in storms.animation_data.drivers)


def test_both_are_paused_while_the_mesh_is_another_and_come_back_in_their_scenes(storms, fast, slow):
    from stormfield.scene.write.mesh_edits import follow_mesh

    first, second = bake_in(fast, storms), bake_in(slow, storms)
    kept = storms.data
    bpy.ops.mesh.primitive_cube_add()
    storms.data = bpy.context.object.data
    follow_mesh(storms)
    bpy.context.view_layer.update()
    assert not any(modifier.show_viewport or modifier.show_render for modifier in storms.modifiers)
    storms.data = kept
    follow_mesh(storms)
    assert off(seen_in(fast, storms), first) < 1e-5
    assert off(seen_in(slow, storms), second) < 1e-5


def test_remove_field_takes_all_of_them_away(storms, fast, slow):
    bake_in(fast, storms)
    bake_in(slow, storms)
    bpy.ops.stormfield.remove_field()
    assert not storms.modifiers
    assert not any("modifiers" in curve.data_path for curve in getattr(storms.animation_data, "drivers", ()))


def test_lambda_follows_the_time_of_each_scene(storms, fast, slow):
    from stormfield.cache.field_cache import open_cache
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    slow.render.frame_map_new = 200
    cache = open_cache(attached_folder(storms, LAMBDA))
    for scene, time in ((fast, 5.0), (slow, 2.5)):
        expected = cache.at((time - 1.0) / 49.0)["sf_advection"]  # λ is keyed over the frames 1 to 50 of the first
        assert off(seen_in(scene, storms, name="sf_advection"), expected) < 0.02
