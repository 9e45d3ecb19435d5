# SPDX-License-Identifier: GPL-3.0-or-later
"""A copy of an object is its own: its λ, its field, its caches; solving one never changes another."""

import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from fields_seen import key_lambda, moving, off, seen, seen_without_addon

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def solved(storms):
    moving(storms)
    storms.animation_data_clear()
    storms.stormfield.lam = 0.0
    bpy.ops.stormfield.solve()
    return storms


def duplicate(obj, linked=False):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.duplicate(linked=linked)
    bpy.context.view_layer.update()
    return bpy.context.object


def scripted(obj):
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)
    bpy.context.view_layer.update()
    return copy


WAYS = {"Shift D": duplicate, "Alt D": lambda obj: duplicate(obj, linked=True), "script": scripted}


@pytest.mark.parametrize("way", WAYS)
def test_a_copy_follows_its_own_lambda(solved, way):
    copy = WAYS[way](solved)
    at_zero = seen(solved)
    assert np.array_equal(seen(copy), at_zero)
    copy.stormfield.lam = 1.0
    bpy.context.view_layer.update()
    assert np.array_equal(seen(solved), at_zero) and off(seen(copy), at_zero) > 0.2
    solved.stormfield.lam, copy.stormfield.lam = 1.0, 0.0
    bpy.context.view_layer.update()
    assert np.array_equal(seen(copy), at_zero) and off(seen(solved), at_zero) > 0.2


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("first", [False, True], ids=["the copy", "the first"])
def test_solving_one_never_changes_the_other(solved, way, first):
    copy = WAYS[way](solved)
    files = sorted(Path(bpy.path.abspath(solved.modifiers[0].cache_file.filepath)).parent.rglob("*"))
    changed, other = (solved, copy) if first else (copy, solved)
    before = seen(other)
    bpy.context.view_layer.objects.active = changed
    for element in changed.stormfield.elements:
        element.kind = "sink"
    bpy.ops.stormfield.solve()
    assert np.array_equal(seen(other), before) and off(seen(changed), before) > 0.2
    other.stormfield.lam = 0.7
    changed.stormfield.lam = 0.2
    bpy.context.view_layer.update()
    for obj, lam in ((other, 0.7), (changed, 0.2)):
        from stormfield.scene.read.current_field import cache_of
        from stormfield.scene.read.mesh import read_mesh

        assert off(seen(obj), cache_of(obj, read_mesh(obj)).at(lam)["sf_advection"]) < 1e-5
    assert all(path.exists() for path in files)


def test_baking_one_never_changes_the_other(solved, scene):
    scene.frame_end = 3
    solved.stormfield.bake.period = 3
    bpy.ops.stormfield.bake()
    copy = duplicate(solved)
    before = seen(solved, 2, "sf_phase_a")
    key_lambda(copy, (1, 1.0), (3, 1.0))
    bpy.context.view_layer.objects.active = copy
    bpy.ops.stormfield.bake()
    assert np.array_equal(seen(solved, 2, "sf_phase_a"), before)
    assert np.abs(seen(copy, 2, "sf_phase_a") - before).max() > 1e-3


def test_no_bytes_are_copied_before_they_differ(solved, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    before = sorted((tmp_path / "stormfield_cache").rglob("*"))
    for _ in range(3):
        duplicate(solved)
    bpy.ops.wm.save_mainfile()
    assert sorted((tmp_path / "stormfield_cache").rglob("*")) == before
    assert len({file.session_uid for file in bpy.data.cache_files}) == 4


def test_copies_keep_their_own_after_saving_and_without_the_addon(solved, tmp_path):
    copy = duplicate(solved)
    copy.name = "Copy"
    key_lambda(solved, (1, 0.0), (11, 1.0))
    key_lambda(copy, (1, 1.0), (11, 0.0))
    expected = {name: [seen(bpy.data.objects[name], frame) for frame in (1, 11)] for name in ("Ball", "Copy")}
    path = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    for name, fields in expected.items():
        assert np.array_equal(seen_without_addon(path, name, [1, 11], tmp_path), fields)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert [m.cache_file for m in bpy.data.objects["Ball"].modifiers] != [
        m.cache_file for m in bpy.data.objects["Copy"].modifiers
    ]
    for name, fields in expected.items():
        assert np.array_equal([seen(bpy.data.objects[name], frame) for frame in (1, 11)], fields)


def test_undo_of_a_copy_and_deletion_of_the_first_do_no_harm(solved):
    bpy.ops.ed.undo_push(message="solved")
    copy = duplicate(solved)
    bpy.ops.ed.undo_push(message="copied")
    name = copy.name
    before = seen(solved)
    bpy.ops.ed.undo()
    assert name not in bpy.data.objects and np.array_equal(seen(bpy.data.objects["Ball"]), before)
    bpy.ops.ed.redo()
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    copy = bpy.data.objects[name]
    bpy.context.view_layer.update()
    assert np.array_equal(seen(copy), before)
    copy.stormfield.lam = 1.0
    bpy.context.view_layer.update()
    assert off(seen(copy), before) > 0.2


def test_a_copy_whose_first_is_deleted_at_once_follows_its_own_lambda(solved):
    before = seen(solved)
    copy = solved.copy()
    bpy.context.collection.objects.link(copy)
    bpy.data.objects.remove(solved)
    bpy.context.view_layer.update()
    copy.stormfield.lam = 1.0
    bpy.context.view_layer.update()
    assert off(seen(copy), before) > 0.2


def test_instances_follow_their_object(solved, scene):
    collection = bpy.data.collections.new("Storms")
    collection.objects.link(solved)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    scene.collection.objects.link(empty)
    solved.stormfield.lam = 1.0
    bpy.context.view_layer.update()
    expected = seen(solved)
    found = []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance and instance.object.original == solved:
            values = np.zeros(len(instance.object.data.vertices) * 3, np.float32)
            instance.object.data.attributes["sf_advection"].data.foreach_get("vector", values)
            found.append(values.reshape(-1, 3))
    assert len(found) == 1 and np.array_equal(found[0], expected)


def test_a_renamed_object_is_analyzed_into_the_same_collection(solved):
    bpy.ops.stormfield.analyze()
    number = len(bpy.data.collections), len(bpy.data.objects)
    solved.name = "Planet"
    solved.modifiers[0].name = "Field"
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.analyze()
    assert (len(bpy.data.collections), len(bpy.data.objects)) == number and len(solved.modifiers) == 1
