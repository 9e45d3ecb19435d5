# SPDX-License-Identifier: GPL-3.0-or-later
"""What a farm has baked without saving the scene is offered where it belongs to the scene's settings."""

import json
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from stormfield.cli import main
from stormfield.scene.read.attached import FRAMES, LAMBDA, MORSE, attached_folder
from stormfield.session import found_caches, freshness

ALL = ["field", "flowing texture", "Morse sets"]


@pytest.fixture
def scene_file(storms, scene, tmp_path):
    """The storms with keys of λ over 4 frames, saved and never solved here."""
    scene.frame_end = 4
    for frame, lam in ((1, 0.0), (4, 1.0)):
        storms.stormfield.lam = lam
        storms.keyframe_insert("stormfield.lam", frame=frame)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def opened(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    ball = bpy.data.objects["Ball"]
    bpy.context.view_layer.objects.active = ball
    return ball


def offered(path):
    """The object of the file, and what is offered for it after loading."""
    ball = opened(path)
    found_caches.look()
    return ball, found_caches.offered(ball)


def farm(path, *arguments):
    """Bakes as another process would: the file stays as it was."""
    before = path.read_bytes()
    assert main(["bake", str(path), *arguments]) == 0
    assert path.read_bytes() == before


def test_one_click_shows_what_a_farm_baked(scene_file, attribute):
    assert offered(scene_file)[1] == []
    farm(scene_file, "--targets", "usd,morse")
    bpy.context.scene.frame_set(3)
    expected = {name: attribute(bpy.data.objects["Ball"], name) for name in ("sf_advection", "sf_phase_a")}
    ball, words = offered(scene_file)
    assert words == ALL and attached_folder(ball, LAMBDA) is None
    assert bpy.ops.stormfield.use_baked_caches() == {"FINISHED"}
    assert found_caches.offered(ball) == [] and freshness.why_out_of_date(ball) == ""
    assert all(attached_folder(ball, name) is not None for name in (LAMBDA, FRAMES, MORSE))
    bpy.context.scene.frame_set(3)
    assert all(np.array_equal(attribute(ball, name), values) for name, values in expected.items())
    bpy.ops.wm.save_mainfile()
    assert offered(scene_file)[1] == []  # all of it is shown


def test_unfinished_bakes_are_not_offered(scene_file):
    farm(scene_file, "--frames", "1-2")
    assert offered(scene_file)[1] == ["field"]
    farm(scene_file, "--frames", "3-4")
    assert offered(scene_file)[1] == ["field", "flowing texture"]


@pytest.mark.parametrize("change", ["design", "keys", "bake"])
def test_what_belongs_to_other_settings_is_not_offered(scene_file, change):
    farm(scene_file)
    ball = opened(scene_file)
    if change == "design":
        ball.stormfield.elements[0].strength = 0.5
    elif change == "keys":
        ball.keyframe_insert("stormfield.lam", frame=2)
    else:
        ball.stormfield.bake.period += 1
    found_caches.look()
    assert found_caches.offered(ball) == ([] if change == "design" else ["field"])
    result = bpy.ops.stormfield.use_baked_caches()
    assert result == ({"CANCELLED"} if change == "design" else {"FINISHED"})
    assert attached_folder(ball, FRAMES) is None


def test_what_was_solved_or_baked_here_meanwhile_is_not_offered(scene_file):
    farm(scene_file)
    ball, words = offered(scene_file)
    assert words == ["field", "flowing texture"]
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    assert found_caches.offered(ball) == []


def test_a_blender_that_cannot_show_caches_is_offered_no_button(scene_file, monkeypatch):
    from stormfield.operators import requirements

    opened(scene_file)
    assert bpy.ops.stormfield.use_baked_caches.poll()
    monkeypatch.setattr(requirements, "problem", lambda: "This Blender was built without USD")
    assert not bpy.ops.stormfield.use_baked_caches.poll()


def test_a_scene_that_cannot_be_read_is_offered_nothing(scene_file):
    farm(scene_file)
    ball = opened(scene_file)
    ball.stormfield.elements[0].source = None
    found_caches.look()
    assert found_caches.offered(ball) == []


def test_info_says_what_is_shown_and_what_is_baked(scene_file, capfd):
    farm(scene_file)
    capfd.readouterr()
    assert main(["info", str(scene_file)]) == 0
    out, err = capfd.readouterr()
    content = json.loads(out)
    assert content["schema"] == "stormfield.scene_info/1"
    (field,) = content["fields"]
    assert field["object"] == "Ball" and field["shown"] == {} and field["baked"].keys() == {"solved", "usd"}
    assert "'Ball': baked for its settings, and not shown yet: field, flowing texture" in err
    assert main(["bake", str(scene_file), "--resume", "--save"]) == 0
    capfd.readouterr()
    assert main(["info", str(scene_file)]) == 0
    out, err = capfd.readouterr()
    (field,) = json.loads(out)["fields"]
    assert field["shown"] == field["baked"] and "not shown" not in err


def test_loading_looks_only_where_there_is_a_window(scene_file, monkeypatch):
    registered = []
    monkeypatch.setattr(bpy.app.timers, "register", lambda work, **_: registered.append(work), raising=False)
    opened(scene_file)
    assert registered == []
    window = SimpleNamespace(background=False, timers=bpy.app.timers)
    monkeypatch.setattr(found_caches, "bpy", SimpleNamespace(app=window))
    found_caches.look_soon()
    assert registered == [found_caches.look]


def test_the_panel_shows_the_offer(scene_file):
    from stormfield.ui.baked_caches import draw_offer
    from test_panels import Layout, stand_in

    farm(scene_file)
    ball = opened(scene_file)
    drawn = []
    draw_offer(stand_in(bpy.context), Layout(drawn), ball)
    assert drawn == []
    found_caches.look()
    draw_offer(stand_in(bpy.context), Layout(drawn), ball)
    assert drawn == ["stormfield.use_baked_caches"]
