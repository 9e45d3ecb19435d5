# SPDX-License-Identifier: GPL-3.0-or-later
"""The λ cache: bit-identical, deterministic, never half true."""

import errno
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from stormfield.cache import checksums, usd
from stormfield.cache.field_cache import FieldCacheWriter, FrameCacheWriter, open_cache
from stormfield.cache.store import delete_cache
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.model.polygons import Polygons
from stormfield.work import run

LAMBDAS = [0.0, 0.1, 0.5, 1.0]
SETTINGS = {"design": {"elements": [{"name": "west storm"}]}, "samples": 4}


def grid(n=6, seed=0):
    """A bumpy square of float64 positions that float32 cannot hold."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), 0.1 * rng.random(n * n)], axis=1)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    return MeshData(vertices, triangles)


def sample(mesh, j):
    rng = np.random.default_rng(100 + j)
    n = len(mesh.vertices)
    vectors = {name: rng.normal(size=(n, 3)).astype(np.float32) for name in ("sf_orientation", "sf_advection")}
    return vectors | {name: rng.normal(size=n).astype(np.float32) for name in ("sf_speed", "sf_stream")}


def bake(folder, mesh, lambdas=LAMBDAS, only=None, settings=SETTINGS, join=True, **options):
    writer = FieldCacheWriter(folder, mesh, lambdas, settings, **options)
    for j in writer.missing():
        if only is None or j in only:
            writer.write_sample(j, sample(mesh, j))
    return not join or run(writer.finish())


def contents(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


@pytest.fixture(scope="module")
def mesh():
    return grid()


@pytest.fixture
def baked(mesh, tmp_path):
    assert bake(tmp_path / "cache", mesh)
    return tmp_path / "cache"


# What is read is what was written ----------------------------------------------------------------------------


def test_samples_come_back_bit_for_bit(mesh, baked):
    cache = open_cache(baked)
    assert np.array_equal(cache.lambdas, LAMBDAS)
    for j in range(len(LAMBDAS)):
        read, written = cache.sample(j), sample(mesh, j)
        assert read.keys() == written.keys()
        for name in written:
            assert read[name].dtype == np.float32
            assert read[name].tobytes() == written[name].tobytes()


def test_mesh_comes_back_bit_for_bit_even_in_double(mesh, baked):
    read = open_cache(baked).mesh
    assert not np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32))
    assert read.vertices.tobytes() == mesh.vertices.tobytes()
    assert np.array_equal(read.triangles, mesh.triangles)
    assert read.fingerprint() == mesh.fingerprint()


def test_between_samples_is_linear(mesh, baked):
    cache = open_cache(baked)
    middle = 0.5 * (sample(mesh, 1)["sf_speed"] + sample(mesh, 2)["sf_speed"])
    assert np.allclose(cache.at(0.3)["sf_speed"], middle, atol=1e-6)
    assert np.array_equal(cache.at(2.0)["sf_speed"], sample(mesh, 3)["sf_speed"])
    assert np.array_equal(cache.at(0.1)["sf_speed"], sample(mesh, 1)["sf_speed"])
    assert cache.values("sf_advection").shape == (4, len(mesh.vertices), 3)


def test_usd_itself_joins_the_samples(mesh, baked):
    stage = usd.usd().Usd.Stage.Open(str(baked / "field.usdc"))
    primvar = stage.GetPrimAtPath(usd.PRIM).GetAttribute("primvars:sf_speed")
    assert np.array_equal(np.array(primvar.Get(500.0)), sample(mesh, 2)["sf_speed"])
    middle = 0.5 * (sample(mesh, 2)["sf_speed"] + sample(mesh, 3)["sf_speed"])
    assert np.allclose(np.array(primvar.Get(750.0)), middle, atol=1e-6)


def test_polygons_are_kept(mesh, tmp_path):
    n = 6
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=1).astype(np.int32)
    polygons = Polygons(np.full(len(quads), 4, np.int32), quads.ravel())
    assert bake(tmp_path, mesh, polygons=polygons)
    stage = usd.usd().Usd.Stage.Open(str(tmp_path / "field.usdc"))
    prim = stage.GetPrimAtPath(usd.PRIM)
    assert np.array_equal(prim.GetAttribute("faceVertexCounts").Get(), polygons.counts)
    assert np.array_equal(prim.GetAttribute("faceVertexIndices").Get(), polygons.indices)
    assert np.array_equal(open_cache(tmp_path).mesh.triangles, mesh.triangles)


def test_a_frame_cache_has_the_frames_as_time_codes(mesh, tmp_path):
    writer = FrameCacheWriter(tmp_path, mesh, range(-1, 3), {})
    for j in writer.missing():
        writer.write_sample(j, {"sf_blend": np.full(len(mesh.vertices), j, np.float32)})
    assert sorted(p.name for p in (tmp_path / "frames").glob("*.usdc")) == [
        "frame_-0001.usdc", "frame_0000.usdc", "frame_0001.usdc", "frame_0002.usdc",
    ]  # fmt: skip
    assert run(writer.finish())
    stage = usd.usd().Usd.Stage.Open(str(tmp_path / "field.usdc"))
    assert stage.GetPrimAtPath(usd.PRIM).GetAttribute("primvars:sf_blend").Get(1.5)[0] == 2.5
    with pytest.raises(InputError, match="not over λ"):
        _ = open_cache(tmp_path).lambdas


# Determinism -------------------------------------------------------------------------------------------------


def test_any_split_gives_the_same_bytes(mesh, baked, tmp_path):
    split = tmp_path / "split"
    assert not bake(split, mesh, only={3, 1})
    assert not (split / "manifest.json").exists()
    assert bake(split, mesh, only={0, 2})
    assert contents(split) == contents(baked)


def test_folders_of_two_machines_can_be_joined(mesh, baked, tmp_path):
    assert not bake(tmp_path / "a", mesh, only={0, 1})
    assert not bake(tmp_path / "b", mesh, only={2, 3})
    shutil.copytree(tmp_path / "a", tmp_path / "b", dirs_exist_ok=True)
    assert bake(tmp_path / "b", mesh, only=set(), resume=True)
    assert contents(tmp_path / "b") == contents(baked)


def test_another_process_writes_the_same_bytes(mesh, baked, tmp_path):
    code = "import sys; sys.path.insert(0, sys.argv[2]); import test_cache as t; t.bake(sys.argv[1], t.grid())"
    here = Path(__file__).parent
    subprocess.run([sys.executable, "-c", code, tmp_path / "other", here], check=True)
    expected, found = contents(baked), contents(tmp_path / "other")
    assert expected.keys() == found.keys()
    for name in expected:
        if name.endswith(".usdc"):  # other releases of USD write another version number into the file's head
            assert expected[name][32:] == found[name][32:]


def test_manifest_is_checked_by_others(baked):
    manifest = json.loads((baked / "manifest.json").read_text())
    assert manifest["schema"] == "stormfield.cache/2"
    assert manifest["time_codes"] == [0.0, 100.0, 500.0, 1000.0]
    assert manifest["settings"] == SETTINGS
    found = {name: hashlib.sha256(data).hexdigest() for name, data in contents(baked).items()}
    assert found.keys() - manifest["files"].keys() == {"manifest.json"}
    assert all(found[name] == digest for name, digest in manifest["files"].items())


# Resume and damage -------------------------------------------------------------------------------------------


def test_resume_starts_at_the_first_missing_sample(mesh, baked, tmp_path):
    folder = tmp_path / "stopped"
    bake(folder, mesh, only={0, 1})
    writer = FieldCacheWriter(folder, mesh, LAMBDAS, SETTINGS, resume=True)
    assert writer.missing() == [2, 3]
    assert bake(folder, mesh, resume=True)
    assert contents(folder) == contents(baked)


def test_without_resume_everything_is_written_again(mesh, baked):
    before = contents(baked)
    assert FieldCacheWriter(baked, mesh, LAMBDAS, SETTINGS).missing() == [0, 1, 2, 3]
    assert bake(baked, mesh)
    assert contents(baked) == before


def damage(path, how):
    data = path.read_bytes()
    if how == "delete":
        path.unlink()
    else:
        path.write_bytes(data[:-50] if how == "truncate" else data[:200] + bytes([data[200] ^ 1]) + data[201:])


DAMAGES = pytest.mark.parametrize("how", ["truncate", "flip", "delete"])


@DAMAGES
def test_a_damaged_sample_is_written_again(mesh, baked, tmp_path, how):
    folder = tmp_path / "stopped"
    bake(folder, mesh, only={0, 1, 2})
    damage(folder / "samples/lam_0002.usdc", how)
    assert FieldCacheWriter(folder, mesh, LAMBDAS, SETTINGS, resume=True).missing() == [2, 3]
    assert bake(folder, mesh, resume=True)
    assert contents(folder) == contents(baked)


@DAMAGES
def test_a_damaged_cache_is_refused_and_baked_again(mesh, baked, how):
    before = contents(baked)
    open_cache(baked).sample(2)
    damage(baked / "field.usdc", how)
    for read in (lambda cache: cache.sample(2), lambda cache: cache.values("sf_speed")):
        with pytest.raises(InputError, match=r"field\.usdc"):
            read(open_cache(baked))
    assert FieldCacheWriter(baked, mesh, LAMBDAS, SETTINGS, resume=True).missing() == [0, 1, 2, 3]
    assert bake(baked, mesh, resume=True)
    assert contents(baked) == before


def test_a_finished_cache_is_two_files(baked):
    assert set(contents(baked)) == {"field.usdc", "manifest.json"}
    assert not (baked / "samples").exists()


def test_samples_that_are_written_at_once_give_the_same_files(mesh, baked, tmp_path):
    writer = FieldCacheWriter(tmp_path / "all", mesh, LAMBDAS, SETTINGS)
    run(writer.write_all(sample(mesh, j) for j in range(len(LAMBDAS))))
    assert contents(tmp_path / "all") == contents(baked)
    assert run(writer.finish()) and contents(tmp_path / "all") == contents(baked)
    bad = sample(mesh, 0) | {"sf_speed": np.full(len(mesh.vertices), np.nan, np.float32)}
    again = FieldCacheWriter(tmp_path / "bad", mesh, LAMBDAS, SETTINGS)
    with pytest.raises(InputError, match="sf_speed of sample 1 is not finite"):
        run(again.write_all([sample(mesh, 0), bad, bad, bad]))
    assert set(contents(tmp_path / "bad")) == {"plan.json"}


def test_samples_that_are_not_there_yet_are_waited_for(mesh, baked, tmp_path):
    writer = FieldCacheWriter(tmp_path / "late", mesh, LAMBDAS, SETTINGS)
    late = (each for j in range(len(LAMBDAS)) for each in (None, None, sample(mesh, j)))
    fractions = [step.fraction for step in writer.write_all(late)]
    assert fractions == sorted(fractions)
    assert contents(tmp_path / "late") == contents(baked)
    short = FieldCacheWriter(tmp_path / "short", mesh, LAMBDAS, SETTINGS)
    with pytest.raises(ValueError, match=f"{len(LAMBDAS) - 1} of {len(LAMBDAS)} samples are missing"):
        run(short.write_all([sample(mesh, 0), None]))
    assert set(contents(tmp_path / "short")) == {"plan.json"}


def test_writing_at_once_that_is_closed_leaves_nothing(mesh, tmp_path):
    writer = FieldCacheWriter(tmp_path, mesh, LAMBDAS, SETTINGS)
    steps = writer.write_all(sample(mesh, j) for j in range(len(LAMBDAS)))
    next(steps)
    steps.close()
    assert set(contents(tmp_path)) == {"plan.json"}


def test_a_part_that_is_baked_anew_takes_the_others_out_of_the_finished_cache(mesh, baked):
    before = contents(baked)
    writer = FieldCacheWriter(baked, mesh, LAMBDAS, SETTINGS)
    writer.write_sample(1, sample(mesh, 1))
    parts = contents(baked)
    assert {f"samples/lam_{j:04d}.usdc" for j in range(4)} <= parts.keys() and "manifest.json" not in parts
    assert run(FieldCacheWriter(baked, mesh, LAMBDAS, SETTINGS, resume=True).finish(verify=True))
    assert contents(baked) == before


def test_a_new_bake_withdraws_the_manifest_first(mesh, baked):
    writer = FieldCacheWriter(baked, mesh, LAMBDAS, SETTINGS)
    writer.write_sample(0, sample(mesh, 0))
    with pytest.raises(InputError, match="no finished cache"):
        open_cache(baked)


def test_other_settings_start_anew_and_cannot_be_resumed(mesh, baked):
    with pytest.raises(InputError, match="other settings"):
        FieldCacheWriter(baked, mesh, LAMBDAS, {"samples": 5}, resume=True)
    FieldCacheWriter(baked, mesh, LAMBDAS, {"samples": 5})
    assert set(contents(baked)) == {"plan.json"}


# Refusals ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("resume", [False, True])
def test_a_foreign_mesh_is_refused(mesh, baked, resume):
    before = contents(baked)
    other = grid(seed=1)
    with pytest.raises(InputError, match="another mesh"):
        FieldCacheWriter(baked, other, LAMBDAS, SETTINGS, resume=resume)
    with pytest.raises(InputError, match="another mesh"):
        open_cache(baked).check_mesh(other)
    open_cache(baked).check_mesh(mesh)
    assert contents(baked) == before
    assert bake(baked, other, replace=True)


def test_a_newer_schema_is_refused(mesh, baked):
    path = baked / "manifest.json"
    path.write_text(path.read_text().replace("stormfield.cache/2", "stormfield.cache/3"))
    for action in (lambda: open_cache(baked), lambda: bake(baked, mesh), lambda: bake(baked, mesh, replace=True)):
        with pytest.raises(InputError, match="newer than"):
            action()


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "other/1"}', '{"schema": "stormfield.cache/2"}'])
def test_a_file_that_is_no_manifest_is_refused(baked, text):
    (baked / "manifest.json").write_text(text)
    with pytest.raises(InputError, match=r"manifest\.json"):
        open_cache(baked)


def test_a_cache_of_schema_1_is_read(mesh, baked):
    """It has value clips, a file for each sample, and its mesh in a file of its own."""
    manifest = json.loads((baked / "manifest.json").read_text())
    manifest["schema"] = "stormfield.cache/1"
    (baked / "field.usdc").rename(baked / "mesh.usdc")
    (baked / "samples").mkdir()
    for j, time_code in enumerate(manifest["time_codes"]):
        usd.write_sample(baked / f"samples/lam_{j:04d}.usdc", time_code, sample(mesh, j))
    for name in ("field.usda", "clips.usda"):
        (baked / name).write_text("#usda 1.0\n")
    files = {name: data for name, data in contents(baked).items() if name != "manifest.json"}
    manifest["files"] = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()}
    (baked / "manifest.json").write_text(json.dumps(manifest))
    for path in (baked, baked / "field.usda"):
        cache = open_cache(path)
        assert cache.mesh.fingerprint() == mesh.fingerprint()
        assert cache.sample(2)["sf_speed"].tobytes() == sample(mesh, 2)["sf_speed"].tobytes()
        assert np.array_equal(cache.values("sf_speed")[3], sample(mesh, 3)["sf_speed"])
    assert bake(baked, mesh, resume=True)  # brought to today's layout
    assert open_cache(baked).mesh.fingerprint() == mesh.fingerprint() and (baked / "field.usdc").exists()
    delete_cache(baked)
    assert not baked.exists()


def test_a_damaged_mesh_is_refused(mesh, baked):
    other = grid(seed=1)
    assert bake(baked.parent / "other", other)
    shutil.copy(baked.parent / "other" / "field.usdc", baked / "field.usdc")
    with pytest.raises(InputError, match="its mesh is not that of the manifest"):
        _ = open_cache(baked).mesh


def test_a_manifest_cannot_name_files_outside(baked):
    path = baked / "manifest.json"
    path.write_text(path.read_text().replace("field.usdc", "../field.usdc"))
    with pytest.raises(InputError, match="not a whole manifest"):
        open_cache(baked)


def test_a_missing_folder_and_a_file_in_its_place(mesh, tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        open_cache(tmp_path / "nowhere")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file"):
        bake(tmp_path / "file", mesh)


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((36, 2)), np.full(36, np.nan)])
def test_arrays_that_do_not_fit_are_refused(mesh, tmp_path, bad):
    writer = FieldCacheWriter(tmp_path, mesh, LAMBDAS, {})
    with pytest.raises(InputError, match="sf_speed of sample 0"):
        writer.write_sample(0, {"sf_speed": bad})


@pytest.mark.parametrize("lambdas", [[], [0.0, 0.0], [0.5, 0.2], [0.0, 1.5]])
def test_lambdas_that_do_not_increase_in_the_unit_interval_are_refused(mesh, tmp_path, lambdas):
    with pytest.raises(InputError):
        FieldCacheWriter(tmp_path, mesh, lambdas, {})


# The disk ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("code", "words"), [(errno.ENOSPC, "the disk is full"), (errno.EACCES, "may not be written")])
def test_a_fault_of_the_disk_keeps_samples_and_leaves_no_litter(mesh, baked, tmp_path, monkeypatch, code, words):
    folder = tmp_path / "full"
    writer = FieldCacheWriter(folder, mesh, LAMBDAS, SETTINGS)
    for j in (0, 1):
        writer.write_sample(j, sample(mesh, j))
    before = contents(folder)

    def torn(path, time_code, attributes):
        path.write_bytes(b"half of a sam")
        raise OSError(code, os.strerror(code), str(path))

    with monkeypatch.context() as patch:
        patch.setattr(usd, "write_sample", torn)
        with pytest.raises(InputError, match=words):
            writer.write_sample(2, sample(mesh, 2))
    assert contents(folder) == before
    assert bake(folder, mesh, resume=True)
    assert contents(folder) == contents(baked)


LIMITED = """
import resource, sys
sys.path.insert(0, sys.argv[2])
import test_cache as t
mesh = t.grid(60)
resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))
try:
    t.bake(sys.argv[1], mesh)
except t.InputError as error:
    print("refused:", error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limits")
def test_usd_reports_a_full_disk_as_one_line(tmp_path):
    """A real refusal in the middle of USD's own writing, not a simulated one."""
    command = [sys.executable, "-c", LIMITED, tmp_path, Path(__file__).parent]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("refused:")]
    assert "the disk is full" in line
    assert set(contents(tmp_path)) == {"plan.json"}


def test_only_files_of_the_cache_are_deleted(mesh, baked, tmp_path):
    (baked / "notes.txt").write_text("mine")
    (baked / "samples").mkdir()
    (baked / "samples/lam_0001.png").write_text("mine")
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "frame_0001.usdc").write_text("mine")
    (baked / "frames").symlink_to(outside)
    delete_cache(baked)
    assert set(contents(baked)) == {"notes.txt", "samples/lam_0001.png"}
    assert (outside / "frame_0001.usdc").exists()


def test_a_deleted_cache_leaves_no_empty_folder(baked):
    delete_cache(baked)
    assert not baked.exists()


# Checksums ---------------------------------------------------------------------------------------------------


def test_what_was_written_is_not_read_again(mesh, tmp_path, monkeypatch):
    read = []
    real = checksums.sha256
    monkeypatch.setattr(checksums, "sha256", lambda path: read.append(path.name) or real(path))
    writer = FieldCacheWriter(tmp_path, mesh, LAMBDAS, SETTINGS, resume=True)
    run(writer.write_all(sample(mesh, j) for j in range(len(LAMBDAS))))
    assert FieldCacheWriter(tmp_path, mesh, LAMBDAS, SETTINGS, resume=True).missing() == []
    open_cache(tmp_path).sample(1)
    assert read == []
    other = tmp_path / "copy"
    shutil.copytree(tmp_path, other)
    for _ in range(2):
        open_cache(other).sample(1)
    assert read == ["field.usdc"]


def test_another_version_of_a_file_is_read(tmp_path):
    path = tmp_path / "file"
    for content in (b"one", b"two", b"three"):
        path.write_bytes(content)
        assert checksums.known_sha256(path) == hashlib.sha256(content).hexdigest()
    (tmp_path / "new").write_bytes(b"seven")
    (tmp_path / "new").replace(path)
    assert checksums.known_sha256(path) == hashlib.sha256(b"seven").hexdigest()
    path.unlink()
    with pytest.raises(FileNotFoundError):
        checksums.known_sha256(path)
