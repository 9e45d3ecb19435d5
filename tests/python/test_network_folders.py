# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches on folders that many machines share: late names, clocks that differ, refused renames, twins. Always the same
bytes as one machine writes, or a clear refusal."""

import os
import time
from pathlib import Path

import pytest
from stormfield.cache import store, usd
from stormfield.cache.field_cache import FieldCacheWriter, open_cache
from stormfield.model.errors import InputError
from stormfield.work import run
from test_cache import LAMBDAS, SETTINGS, bake, contents, grid, sample

HOURS = 3600.0


@pytest.fixture(scope="module")
def mesh():
    return grid(4)


@pytest.fixture(scope="module")
def expected(mesh, tmp_path_factory):
    folder = tmp_path_factory.mktemp("one machine")
    assert bake(folder, mesh)
    return contents(folder)


def machine(folder, mesh):
    return FieldCacheWriter(folder, mesh, LAMBDAS, SETTINGS, resume=True)


def write(writer, mesh, indices):
    for j in indices:
        writer.write_sample(j, sample(mesh, j))


def first():
    return range(len(LAMBDAS) // 2)


def last():
    return range(len(LAMBDAS) // 2, len(LAMBDAS))


@pytest.fixture
def refused(monkeypatch):
    """refused(n, winerror): the next n renames fail as on Windows. Nobody waits in this test."""
    real = Path.replace
    left = [0, 0]

    def replace(self, target):
        if left[0] > 0:
            left[0] -= 1
            error = PermissionError(13, "Permission denied", str(target))
            error.winerror = left[1]
            raise error
        return real(self, target)

    def refuse(count, winerror):
        left[:] = [count, winerror]
        return left

    monkeypatch.setattr(Path, "replace", replace)
    monkeypatch.setattr(store, "RETRY_PAUSE", 0.0)
    return refuse


@pytest.mark.parametrize("winerror", [5, 32, 33])
def test_renames_that_are_refused_for_a_moment_are_tried_again(mesh, expected, tmp_path, refused, winerror):
    writer = machine(tmp_path, mesh)
    refused(2, winerror)
    write(writer, mesh, range(len(LAMBDAS)))
    refused(2, winerror)
    assert run(writer.finish())
    assert contents(tmp_path) == expected


def test_renames_that_stay_refused_end_with_one_line(mesh, tmp_path, refused):
    writer = machine(tmp_path, mesh)
    left = refused(10_000, 5)
    with pytest.raises(InputError, match="may not be written"):
        writer.write_sample(0, sample(mesh, 0))
    assert 0 < 10_000 - left[0] <= store.RETRIES + 2  # given up, not tried for ever
    left[0] = 0
    assert set(contents(tmp_path)) == {"plan.json"}


def test_other_refusals_are_not_tried_again(mesh, tmp_path, refused):
    left = refused(0, 0)
    writer = machine(tmp_path, mesh)
    left[0] = 3
    with pytest.raises(InputError, match="may not be written"):
        writer.write_sample(0, sample(mesh, 0))
    assert left[0] == 2


def test_a_twin_that_comes_late_changes_nothing(mesh, expected, tmp_path):
    """Both machines begin, one finishes the whole cache; the other still writes its samples, and ends well."""
    twin, quick = machine(tmp_path, mesh), machine(tmp_path, mesh)
    assert twin.missing() == list(range(len(LAMBDAS)))
    write(quick, mesh, range(len(LAMBDAS)))
    assert run(quick.finish())
    write(twin, mesh, first())
    assert (tmp_path / "manifest.json").exists()  # and it stays while the twin writes
    assert run(twin.finish())
    assert contents(tmp_path) == expected


def test_a_twin_whose_file_is_taken_away_ends_well(mesh, expected, tmp_path, monkeypatch):
    twin, quick = machine(tmp_path, mesh), machine(tmp_path, mesh)
    real = usd.write_sample

    def overtaken(path, time_code, attributes):
        """While the twin writes, the other machine finishes and tidies up."""
        real(path, time_code, attributes)
        monkeypatch.setattr(usd, "write_sample", real)
        write(quick, mesh, range(len(LAMBDAS)))
        assert run(quick.finish())
        path.unlink()

    monkeypatch.setattr(usd, "write_sample", overtaken)
    twin.write_sample(0, sample(mesh, 0))
    assert run(twin.finish())
    assert contents(tmp_path) == expected


def test_a_twin_at_work_keeps_its_file_while_the_other_finishes(mesh, expected, tmp_path):
    machine(tmp_path, mesh)
    live = tmp_path / "samples" / ".tmp-otherhost-77-lam_0000.usdc"
    live.write_bytes(b"half")
    assert bake(tmp_path, mesh, resume=True)
    assert live.exists()
    live.unlink()
    assert contents(tmp_path) == expected


@pytest.mark.parametrize("ahead", [2 * HOURS, -2 * HOURS])
def test_clocks_that_differ_take_no_file_from_its_writer(mesh, tmp_path, monkeypatch, ahead):
    machine(tmp_path, mesh)
    live = tmp_path / "samples" / ".tmp-otherhost-77-lam_0000.usdc"
    live.write_bytes(b"half")
    real = time.time
    monkeypatch.setattr(time, "time", lambda: real() + ahead)
    machine(tmp_path, mesh)
    assert live.exists()
    # By the folder's own clock it has not been touched for two hours: nobody works on it.
    stamp = live.stat().st_mtime - 2 * HOURS
    os.utime(live, (stamp, stamp))
    machine(tmp_path, mesh)
    assert not live.exists()


def test_a_join_that_comes_early_writes_nothing_and_names_what_is_missing(mesh, expected, tmp_path):
    writer, joiner = machine(tmp_path, mesh), machine(tmp_path, mesh)
    write(writer, mesh, first())
    before = contents(tmp_path)
    assert not run(joiner.finish())
    assert contents(tmp_path) == before
    assert joiner.absent() == [f"samples/lam_{j:04d}.usdc" for j in last()]
    write(writer, mesh, last())
    assert joiner.absent() == [] and run(joiner.finish())
    assert contents(tmp_path) == expected


def test_names_that_appear_late_are_waited_for(mesh, expected, tmp_path, monkeypatch):
    """A network folder shows what another machine wrote only at the third listing."""
    writer, joiner = machine(tmp_path, mesh), machine(tmp_path, mesh)
    write(writer, mesh, range(len(LAMBDAS)))
    real, listings = Path.iterdir, [0]

    def stale(self):
        if self.name == "samples":
            listings[0] += 1
            if listings[0] < 3:
                return iter([])
        return real(self)

    monkeypatch.setattr(Path, "iterdir", stale)
    assert not run(joiner.finish()) and not run(joiner.finish())
    assert run(joiner.finish())
    monkeypatch.undo()
    assert contents(tmp_path) == expected


def test_a_chunk_vouches_for_its_samples_and_verify_reads_them(mesh, expected, tmp_path, monkeypatch):
    writer = machine(tmp_path, mesh)
    write(writer, mesh, range(len(LAMBDAS)))
    damaged = tmp_path / "samples" / "lam_0001.usdc"
    whole = damaged.read_bytes()
    damaged.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    read = []
    real = store.sha256
    monkeypatch.setattr(store, "sha256", lambda path: read.append(path.name) or real(path))
    joiner = machine(tmp_path, mesh)
    assert not run(joiner.finish(verify=True))
    assert "lam_0001.usdc" in read
    damaged.write_bytes(whole)
    read.clear()
    assert run(machine(tmp_path, mesh).finish())
    assert not [name for name in read if name.startswith("lam_")]  # ten thousand frames are not read to be joined
    assert contents(tmp_path) == expected


def test_a_lost_answer_to_a_rename_is_no_fault(tmp_path, monkeypatch):
    """The server renamed the file, the answer was lost, and the repeated request finds nothing to rename."""
    temporary, final = tmp_path / "a", tmp_path / "b"
    temporary.write_bytes(b"content")
    real, calls = Path.replace, [0]

    def lossy(self, target):
        calls[0] += 1
        if calls[0] == 1:
            real(self, target)
            error = PermissionError(13, "Permission denied")
            error.winerror = 32
            raise error
        return real(self, target)

    monkeypatch.setattr(Path, "replace", lossy)
    monkeypatch.setattr(store, "RETRY_PAUSE", 0.0)
    store.rename(temporary, final)
    assert final.read_bytes() == b"content"


@pytest.mark.parametrize("damaged", [False, True])
def test_a_finished_cache_that_lost_its_file_is_not_called_finished(mesh, expected, tmp_path, damaged):
    assert bake(tmp_path, mesh)
    (tmp_path / "field.usdc").unlink()
    if damaged:
        (tmp_path / "field.usdc").write_bytes(b"damaged")
    joiner = machine(tmp_path, mesh)
    assert not run(joiner.finish())
    assert joiner.absent() == [f"samples/lam_{j:04d}.usdc" for j in range(len(LAMBDAS))]
    assert not (tmp_path / "manifest.json").exists()  # nobody takes it for whole
    assert bake(tmp_path, mesh, resume=True)
    assert contents(tmp_path) == expected


def test_two_machines_may_join_at_once(mesh, expected, tmp_path, monkeypatch):
    """The later one finds the samples taken in, and their files removed."""
    slow, quick = machine(tmp_path, mesh), machine(tmp_path, mesh)
    write(quick, mesh, range(len(LAMBDAS)))
    joining = slow.finish()
    with monkeypatch.context() as elsewhere:
        elsewhere.setattr(store.socket, "gethostname", lambda: "elsewhere")
        next(joining)
    assert run(quick.finish())
    assert run(joining)
    assert contents(tmp_path) == expected


def test_a_machine_that_dies_while_it_tidies_up_leaves_a_whole_cache(mesh, expected, tmp_path, monkeypatch):
    writer = machine(tmp_path, mesh)
    write(writer, mesh, range(len(LAMBDAS)))

    def die(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(store.CacheStore, "_clean", die)
    with pytest.raises(KeyboardInterrupt):
        run(writer.finish())
    monkeypatch.undo()
    assert open_cache(tmp_path).sample(1).keys() == sample(mesh, 1).keys()
    assert machine(tmp_path, mesh).missing() == []
    assert run(machine(tmp_path, mesh).finish())
    assert contents(tmp_path) == expected
