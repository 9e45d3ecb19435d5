# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields from other files: appended, linked and overridden; the library's own caches are never touched."""

import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from fields_seen import key_lambda, moving, off, seen, seen_without_addon

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def library(storms, scene, tmp_path):
    """A file with the storms in a collection, solved and baked; λ runs from 0 to 1 over frames 1 to 5."""
    scene.frame_end = 5
    moving(storms)
    key_lambda(storms, (1, 0.0), (5, 1.0))
    collection = bpy.data.collections.new("Planet")
    scene.collection.children.link(collection)
    for obj in list(scene.collection.objects):
        scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    bpy.context.view_layer.objects.active = storms
    storms.stormfield.bake.period = 4
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    path = tmp_path / "library" / "planet.blend"
    path.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def contents(root):
    return {p.relative_to(root).as_posix(): p.read_bytes() for p in sorted(root.rglob("*")) if p.is_file()}


def new_shot(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    path = tmp_path / "shots" / "shot.blend"
    path.parent.mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.context.scene.frame_end = 5
    return path


def load(library, link):
    with bpy.data.libraries.load(str(library), link=link, relative=True) as (_there, here):
        here.collections = ["Planet"]
    bpy.context.scene.collection.children.link(here.collections[0])
    bpy.context.view_layer.update()
    return here.collections[0]


def overridden(library):
    """The linked collection with everything in it overridden, as Make Library Override does."""
    collection = load(library, link=True)
    collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
    bpy.context.view_layer.update()
    ball = next(obj for obj in bpy.data.objects if obj.name.startswith("Ball") and obj.override_library)
    bpy.context.view_layer.objects.active = ball
    return ball


def reopened(path):
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return next(obj for obj in bpy.data.objects if obj.name.startswith("Ball") and not obj.library)


def cache_of(obj):
    from stormfield.scene.read import current_field
    from stormfield.scene.read.mesh import read_mesh

    return current_field.cache_of(obj, read_mesh(obj))


def test_settings_of_an_override_can_be_changed_and_stay(library, tmp_path):
    path = new_shot(tmp_path)
    ball = overridden(library)
    field = ball.stormfield
    for owner, names in ((field, ("lam",)), (field.bake, ("period", "folder", "use_exr")), (field.look, ("style",))):
        assert all(owner.is_property_overridable_library(name) for name in names)
    ball.animation_data_clear()
    field.lam, field.bake.period, field.look.style, field.solve.samples = 0.6, 7, "ARROWS", 4
    ball = reopened(path)
    field = ball.stormfield
    assert (field.bake.period, field.look.style, field.solve.samples) == (7, "ARROWS", 4)


def test_an_override_plays_its_own_lambda(library, tmp_path):
    before = contents(library.parent)
    path = new_shot(tmp_path)
    ball = overridden(library)
    cache = cache_of(ball)
    key_lambda(ball, (1, 1.0), (5, 0.5))
    expected = {frame: cache.at(lam)["sf_advection"] for frame, lam in ((1, 1.0), (3, 0.75), (5, 0.5))}
    assert max(off(seen(ball, frame), field) for frame, field in expected.items()) < 1e-5
    ball = reopened(path)
    assert max(off(seen(ball, frame), field) for frame, field in expected.items()) < 1e-5
    without = seen_without_addon(path, ball.name, expected, tmp_path)
    assert max(off(a, b) for a, b in zip(without, expected.values(), strict=True)) < 1e-5
    assert contents(library.parent) == before


def test_solve_and_bake_of_an_override_go_to_the_shot(library, tmp_path):
    before = contents(library.parent)
    path = new_shot(tmp_path)
    ball = overridden(library)
    first = seen(ball, 3)
    ball.stormfield.elements[0].strength = 0.5
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    root = path.parent / "stormfield_cache"
    assert len(list(root.glob("*/lambda-*"))) == len(list(root.glob("*/frames-*"))) == 1
    field, flow = seen(ball, 3), seen(ball, 3, "sf_phase_a")
    assert off(field, first) > 0.2 and flow.any()
    ball = reopened(path)
    assert np.array_equal(seen(ball, 3), field) and np.array_equal(seen(ball, 3, "sf_phase_a"), flow)
    assert np.array_equal(seen_without_addon(path, ball.name, [3], tmp_path)[0], field)
    assert contents(library.parent) == before
    shutil.move(path.parent, tmp_path / "moved")  # the library stays where it was, one level up
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "moved" / "shot.blend"))
    ball = next(obj for obj in bpy.data.objects if obj.override_library and obj.name.startswith("Ball"))
    assert np.array_equal(seen(ball, 3), field)


def test_an_override_is_analyzed_and_bakes_flow_maps_for_the_shot(library, tmp_path):
    before = contents(library.parent)
    path = new_shot(tmp_path)
    ball = overridden(library)
    ball.stormfield.bake.use_exr, ball.stormfield.bake.resolution = True, "256"
    assert bpy.ops.stormfield.analyze() == {"FINISHED"} and bpy.ops.stormfield.analyze_lambda() == {"FINISHED"}
    bpy.ops.stormfield.bake()
    ball = reopened(path)
    assert Path(bpy.path.abspath(ball.stormfield.bake.flow_maps)).parent.parent == path.parent / "stormfield_cache"
    assert contents(library.parent) == before


def test_saving_a_keyed_override_prints_no_fault(library, tmp_path, capsys):
    path = new_shot(tmp_path)
    ball = overridden(library)
    key_lambda(ball, (1, 0.2), (5, 0.4))
    bpy.ops.wm.save_mainfile(filepath=str(path))
    assert "Traceback" not in capsys.readouterr().err


def test_a_linked_field_shows_and_is_left_alone(library, tmp_path):
    before = contents(library.parent)
    path = new_shot(tmp_path)
    collection = load(library, link=True)
    ball = collection.objects["Ball"]
    files = len(bpy.data.cache_files)
    expected = cache_of(ball).at(0.5)["sf_advection"]
    assert off(seen(ball, 3), expected) < 1e-5
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert off(seen(bpy.data.objects["Ball"], 3), expected) < 1e-5 and len(bpy.data.cache_files) == files
    assert contents(library.parent) == before


@pytest.mark.parametrize("local", [False, True], ids=["append", "make local"])
def test_an_appended_field_is_its_own(library, tmp_path, local):
    before = contents(library.parent)
    path = new_shot(tmp_path)
    collection = load(library, link=local)
    if local:
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.make_local(type="ALL")
    ball = next(obj for obj in bpy.data.objects if obj.name.startswith("Ball") and not obj.library)
    expected = seen(ball, 3)
    assert expected.any()
    assert off(expected, cache_of(ball).at(0.5)["sf_advection"]) < 1e-5
    bpy.context.view_layer.objects.active = ball
    ball.stormfield.elements[0].strength = 0.5
    bpy.ops.stormfield.solve()
    assert off(seen(ball, 3), expected) > 0.2
    assert (path.parent / "stormfield_cache").is_dir() and contents(library.parent) == before
    del collection
    ball = reopened(path)
    assert off(seen(ball, 3), expected) > 0.2


def test_appended_twice_each_has_its_own_lambda(library, tmp_path):
    new_shot(tmp_path)
    first, second = load(library, link=False), load(library, link=False)
    balls = [next(obj for obj in each.objects if obj.name.startswith("Ball")) for each in (first, second)]
    assert balls[0] != balls[1]
    key_lambda(balls[0], (1, 0.0), (5, 0.0))
    key_lambda(balls[1], (1, 1.0), (5, 1.0))
    cache = cache_of(balls[0])
    for ball, lam in zip(balls, (0.0, 1.0), strict=True):
        assert off(seen(ball, 3), cache.at(lam)["sf_advection"]) < 1e-5
