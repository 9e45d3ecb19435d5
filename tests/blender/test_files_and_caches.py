# SPDX-License-Identifier: GPL-3.0-or-later
"""Files keep what they show: versions, first save, Save As, moved folders, recovered sessions, blocked disks, names."""

import os
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
def baked(storms, scene):
    """The storms, unsaved, solved, with flow, flow maps, volumes and Morse sets baked over frames 1 to 3."""
    scene.frame_end = 3
    key_lambda(storms, (1, 0.0), (3, 1.0))
    settings = storms.stormfield.bake
    settings.use_exr = settings.use_vdb = settings.use_morse = True
    settings.resolution, settings.voxel_size, settings.period = "256", 0.2, 4
    if not storms.data.uv_layers:
        storms.data.uv_layers.new(name="Map")
    moving(storms)
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    return storms


@pytest.fixture
def project(tmp_path):
    """A folder beside which no other test has files."""
    return tmp_path / "work" / "film" / "shots"


def folders(root):
    return sorted(path.name.rpartition("-")[0] for path in root.iterdir() if path.is_dir())


def contents(root):
    return {p.relative_to(root).as_posix(): p.read_bytes() for p in sorted(root.rglob("*")) if p.is_file()}


def save(path, **options):
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), **options)


def reopen(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.data.objects["Ball"]


def show_flow_maps(obj):
    """An image that shows the first flow map, and a volume, as an artist uses them."""
    record = obj.stormfield.bake
    image = bpy.data.images.load(bpy.path.abspath(record.flow_maps) + "/frames/frame_0001.exr")
    volume = bpy.data.volumes.new("Bands")
    volume.filepath = bpy.path.abspath(record.volumes) + "/frames/frame_0001.vdb"
    image.use_fake_user = volume.use_fake_user = True
    return image, volume


def test_an_older_version_keeps_field_flow_maps_and_volumes(baked, tmp_path):
    image, _volume = show_flow_maps(baked)
    save(tmp_path / "shot_v001.blend")
    before, flow = seen(baked, 2), seen(baked, 2, "sf_phase_a")
    root = tmp_path / "stormfield_cache" / "Ball"
    kept = contents(root)
    first_map = bpy.path.abspath(image.filepath)
    save(tmp_path / "shot_v002.blend")
    for number in range(6):
        baked.stormfield.elements[0].strength = 0.3 + 0.1 * number
        bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    assert bpy.path.abspath(image.filepath) != first_map and Path(bpy.path.abspath(image.filepath)).is_file()
    bpy.ops.wm.save_mainfile()
    after = contents(root)
    assert all(after[name] == data for name, data in kept.items())
    ball = reopen(tmp_path / "shot_v001.blend")
    assert np.array_equal(seen(ball, 2), before) and np.array_equal(seen(ball, 2, "sf_phase_a"), flow)
    assert bpy.path.abspath(bpy.data.images[0].filepath) == first_map
    assert off(seen(reopen(tmp_path / "shot_v002.blend"), 2), before) > 0.1


def test_the_first_save_brings_everything_along(baked, tmp_path):
    image, volume = show_flow_maps(baked)
    before = seen(baked, 2)
    save(tmp_path / "shot.blend")
    root = tmp_path / "stormfield_cache" / "Ball"
    assert set(folders(root)) == {"exr", "frames", "lambda", "morse", "vdb"}
    assert len(list(root.glob("exr-*/frames/*.exr"))) == len(list(root.glob("vdb-*/frames/*.vdb"))) == 3
    assert baked.stormfield.bake.flow_maps.startswith("//stormfield_cache/Ball/exr-")
    for block in (image, volume, *bpy.data.cache_files):
        assert block.filepath.startswith("//stormfield_cache/Ball/"), block.filepath
        assert Path(bpy.path.abspath(block.filepath)).is_file()
    shutil.rmtree(tmp_path / "temporary")
    assert np.array_equal(seen(reopen(tmp_path / "shot.blend"), 2), before)


def test_a_bake_that_was_stopped_goes_on_beside_the_file(baked, tmp_path):
    plan = next((tmp_path / "temporary").rglob("exr-*/manifest.json"))
    plan.rename(plan.with_name("plan.json"))
    baked.stormfield.bake.flow_maps = ""
    save(tmp_path / "shot.blend")
    assert (tmp_path / "stormfield_cache" / "Ball" / plan.parent.name / "plan.json").is_file()


def test_undo_past_the_first_save_keeps_the_field(baked, tmp_path):
    bpy.ops.ed.undo_push(message="before")
    before = seen(baked, 2)
    save(tmp_path / "shot.blend")
    baked.location.x = 1
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    assert np.array_equal(seen(bpy.data.objects["Ball"], 2), before)


def test_save_as_elsewhere_brings_everything_along(baked, tmp_path):
    show_flow_maps(baked)
    save(tmp_path / "one" / "shot.blend")
    before = seen(baked, 2)
    save(tmp_path / "two" / "deep" / "shot.blend")
    shutil.rmtree(tmp_path / "one")
    shutil.rmtree(tmp_path / "temporary")
    ball = reopen(tmp_path / "two" / "deep" / "shot.blend")
    assert np.array_equal(seen(ball, 2), before)
    for path in (bpy.data.images[0].filepath, bpy.data.volumes[0].filepath, ball.stormfield.bake.flow_maps):
        assert path.startswith("//stormfield_cache/") and Path(bpy.path.abspath(path)).exists()
    shown = seen_without_addon(tmp_path / "two" / "deep" / "shot.blend", "Ball", [2], tmp_path)
    assert np.array_equal(shown[0], before)


def test_a_saved_copy_has_its_own_and_the_open_file_keeps_its(baked, tmp_path):
    save(tmp_path / "one" / "shot.blend")
    before, paths = seen(baked, 2), [file.filepath for file in bpy.data.cache_files]
    record = baked.stormfield.bake.flow_maps
    save(tmp_path / "two" / "copy.blend", copy=True)
    assert [file.filepath for file in bpy.data.cache_files] == paths
    assert baked.stormfield.bake.flow_maps == record and np.array_equal(seen(baked, 2), before)
    shutil.rmtree(tmp_path / "one")
    shutil.rmtree(tmp_path / "temporary")
    ball = reopen(tmp_path / "two" / "copy.blend")
    assert np.array_equal(seen(ball, 2), before)
    assert Path(bpy.path.abspath(ball.stormfield.bake.flow_maps)).is_dir()


def test_a_moved_folder_keeps_the_field(baked, tmp_path):
    save(tmp_path / "old" / "shot.blend", relative_remap=False)
    before = seen(baked, 2)
    bpy.ops.wm.read_homefile(use_empty=True)
    (tmp_path / "old").rename(tmp_path / "Stürme & 100% #1")
    shutil.rmtree(tmp_path / "temporary")
    moved = tmp_path / "Stürme & 100% #1" / "shot.blend"
    assert np.array_equal(seen(reopen(moved), 2), before)
    bpy.ops.wm.save_mainfile()
    assert np.array_equal(seen_without_addon(moved, "Ball", [2], tmp_path)[0], before)


def test_a_recovered_session_is_saved_with_its_caches(baked, tmp_path, monkeypatch):
    from stormfield.scene.read import folders as read_folders
    from stormfield.scene.write import cache_folders

    before = seen(baked, 2)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "autosave.blend"), copy=True)
    # What an autosave of an unsaved file holds: absolute paths into the folder of a session that is gone.
    dead = tmp_path / "temporary"
    bpy.ops.wm.read_homefile(use_empty=True)
    for module in (read_folders, cache_folders):
        monkeypatch.setattr(module, "temporary_root", lambda: tmp_path / "another" / read_folders.NAME)
    ball = reopen(tmp_path / "autosave.blend")
    shutil.rmtree(tmp_path / "stormfield_cache")
    for file in bpy.data.cache_files:
        relative = Path(bpy.path.abspath(file.filepath)).relative_to(tmp_path)
        file.filepath = str(dead / relative)
    save(tmp_path / "project" / "shot.blend")
    shutil.rmtree(dead)
    ball = reopen(tmp_path / "project" / "shot.blend")
    assert all(file.filepath.startswith("//stormfield_cache/Ball/") for file in bpy.data.cache_files)
    assert np.array_equal(seen(ball, 2), before)


def test_what_cannot_be_copied_is_said_kept_and_offered_again(baked, tmp_path, monkeypatch, capsys):
    from stormfield.scene.write import cache_folders
    from stormfield.session import saves

    monkeypatch.setattr(cache_folders, "kept_root", lambda: tmp_path / "kept" / cache_folders.NAME)
    before = seen(baked, 2)
    project = tmp_path / "project"
    project.mkdir()
    (project / "stormfield_cache").write_text("in the way")
    save(project / "shot.blend")
    assert "stormfield_cache" in " ".join(saves.refused()) and "is a file" in capsys.readouterr().err
    shutil.rmtree(tmp_path / "temporary")  # as Blender does when it ends
    ball = reopen(project / "shot.blend")
    assert np.array_equal(seen(ball, 2), before)
    assert cache_folders.stray_folders(ball)
    with pytest.raises(RuntimeError, match="is a file"):
        bpy.ops.stormfield.bring_caches()
    (project / "stormfield_cache").unlink()
    assert bpy.ops.stormfield.bring_caches() == {"FINISHED"}
    assert not cache_folders.stray_folders(ball) and not saves.refused()
    bpy.ops.wm.save_mainfile()
    shutil.rmtree(tmp_path / "kept")
    assert np.array_equal(seen(reopen(project / "shot.blend"), 2), before)


def test_clean_up_deletes_what_no_file_names_and_nothing_else(baked, project):
    save(project / "shot_v001.blend", compress=True)
    first = contents(project / "stormfield_cache")
    save(project / "shot_v002.blend")
    tried = []
    for number in range(3):
        baked.stormfield.elements[0].strength = 0.3 + 0.1 * number
        bpy.ops.stormfield.solve()
        tried.append(Path(bpy.path.abspath(baked.modifiers[0].cache_file.filepath)).parent)
    bpy.ops.wm.save_mainfile()
    (project / "stormfield_cache" / "Ball" / "notes.txt").write_text("mine")
    assert all(folder.is_dir() for folder in tried)
    assert bpy.ops.stormfield.clean_caches() == {"FINISHED"}
    assert [folder.is_dir() for folder in tried] == [False, False, True]
    after = contents(project / "stormfield_cache")
    assert all(after[name] == data for name, data in first.items()) and "Ball/notes.txt" in after
    for name in ("shot_v001.blend", "shot_v002.blend1"):  # a backup counts as a file
        (project / name).unlink()
    reopen(project / "shot_v002.blend")
    assert bpy.ops.stormfield.clean_caches() == {"FINISHED"}
    assert len(list((project / "stormfield_cache" / "Ball").glob("lambda-*"))) == 1


def test_clean_up_keeps_everything_where_a_file_cannot_be_read(baked, tmp_path):
    save(tmp_path / "shot.blend")
    baked.stormfield.elements[0].strength = 0.5
    bpy.ops.stormfield.solve()
    bpy.ops.wm.save_mainfile()
    (tmp_path / "other.blend").write_bytes(b"\x28\xb5\x2f\xfd damaged")
    before = contents(tmp_path / "stormfield_cache")
    bpy.ops.stormfield.clean_caches()
    assert contents(tmp_path / "stormfield_cache") == before


def test_a_file_elsewhere_that_uses_a_cache_folder_is_asked_too(baked, tmp_path):
    baked.stormfield.bake.folder = str(tmp_path / "a" / "disk" / "for" / "caches")
    bpy.ops.stormfield.solve()
    shown = Path(bpy.path.abspath(baked.modifiers[0].cache_file.filepath)).parent
    save(tmp_path / "far" / "away" / "one.blend")
    baked.stormfield.elements[0].strength = 0.5
    bpy.ops.stormfield.solve()
    save(tmp_path / "near" / "two.blend")
    bpy.ops.stormfield.clean_caches()
    assert shown.is_dir()
    (tmp_path / "far" / "away" / "one.blend").unlink()
    bpy.ops.stormfield.clean_caches()
    assert shown.is_dir()  # whether that file is gone or on a disk that is not there, nobody can say


def test_names_that_differ_have_folders_that_differ(ball):
    from stormfield.scene.read.folders import cache_root, file_name

    names = ["a/b", "a:b", "a_b", "CON", "con", "com1.old", "..", ".", "a.", "a ", "ä", "Ball", "ball", "x" * 250, "\t"]
    found = {}
    for name in names:
        obj = ball.copy()
        bpy.context.collection.objects.link(obj)
        obj.name = name
        if obj.name == name:
            found[name] = cache_root(obj).name
    assert len({name.casefold() for name in found.values()}) == len(found)
    assert found["a_b"] == "a_b" and found["ä"] == "ä"
    for name in names:
        made = file_name(name)
        assert made.split(".")[0].upper() not in {"CON", "COM1"} and len(made.encode()) < 220
        assert not made.endswith((".", " ")) and not set(made) & set('\\/:*?"<>|\t')


def test_a_renamed_object_keeps_its_folder_and_finds_its_cache(baked, tmp_path):
    save(tmp_path / "shot.blend")
    root = tmp_path / "stormfield_cache"
    before = set(contents(root))
    baked.name = "Planet"
    baked.modifiers[0].name = "Field"
    for file in bpy.data.cache_files:
        file.name = "renamed"
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.bake()
    assert set(contents(root)) == before and len(baked.modifiers) == 3
    twin = bpy.data.objects.new("Ball", baked.data.copy())
    bpy.context.collection.objects.link(twin)
    twin.stormfield.enabled = True
    from stormfield.scene.read.folders import cache_root

    assert cache_root(twin) != cache_root(baked) and cache_root(baked).name == "Ball"


@pytest.mark.skipif(os.name == "nt", reason="backslashes part folders there anyway")
def test_backslashes_part_folders_as_in_blender(storms, tmp_path):
    save(tmp_path / "file" / "shot.blend")
    storms.stormfield.bake.folder = "//..\\windows\\cache\\"
    bpy.ops.stormfield.solve()
    assert (tmp_path / "windows" / "cache" / "Ball").is_dir()
    assert not any("\\" in path.name for path in tmp_path.rglob("*"))
    assert seen(storms).any()
    bpy.ops.wm.save_mainfile()
    assert seen(reopen(tmp_path / "file" / "shot.blend")).any()


def test_the_cache_folder_may_be_relative_to_the_file(capfd, storms):
    storms.stormfield.bake.folder = "//caches"
    assert "PATH_SUPPORTS_BLEND_RELATIVE" not in capfd.readouterr().err
