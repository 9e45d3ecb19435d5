# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake that is killed at any moment leaves no torn file, and resumes to the very bytes of an undisturbed bake."""

import contextlib
import hashlib
import importlib.util
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from test_cache import contents

KILLS = 20
SAMPLES = 40

# usd-core starts in a fraction of a second; Blender's own USD is tested elsewhere.
BAKE = """
import sys
if sys.argv[3] == "usd-core":
    sys.modules["bpy"] = None
sys.path.insert(0, sys.argv[2])
import test_cache
from stormfield.cache import usd
usd.usd()
mesh = test_cache.grid(40)
print("ready", flush=True)
samples = int(sys.argv[4])
lambdas = [j / (samples - 1) for j in range(samples)]
assert test_cache.bake(sys.argv[1], mesh, lambdas=lambdas, resume=True, join=sys.argv[5] == "join")
"""


def start(folder, join=True):
    flavour = "usd-core" if importlib.util.find_spec("pxr") else "bpy"
    command = [sys.executable, "-c", BAKE, str(folder), str(Path(__file__).parent), flavour, str(SAMPLES)]
    command.append("join" if join else "keep the samples")
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def finish(process):
    assert process.wait(timeout=120) == 0


def temporary(name):
    return name.rpartition("/")[2].startswith(".tmp-")


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The bytes of an undisturbed bake, those of its samples, and the seconds it took."""
    folder = tmp_path_factory.mktemp("reference")
    began = time.monotonic()
    finish(start(folder))
    seconds = time.monotonic() - began
    parts = tmp_path_factory.mktemp("parts")
    finish(start(parts, join=False))
    return contents(folder), {n: data for n, data in contents(parts).items() if n.endswith(".usdc")}, seconds


def check_not_torn(folder, expected):
    for name, data in contents(folder).items():
        if temporary(name) or name == "plan.json":
            continue
        if name.endswith(".sha256"):
            sample = name.removesuffix(".sha256")
            assert data.decode().split() == [hashlib.sha256(expected[sample]).hexdigest(), Path(sample).name]
        else:
            assert data == expected[name], f"{name} is torn"


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_killed_twenty_times_at_random_moments(reference, tmp_path):
    expected, parts, seconds = reference
    rng = random.Random(6)
    killed = killed_at_work = 0
    rounds = 0
    folder = tmp_path / "0"
    while killed < KILLS:
        process = start(folder)
        time.sleep(rng.uniform(0.0, 0.25 * seconds))
        process.send_signal(signal.SIGKILL)
        if process.wait() == -signal.SIGKILL:
            killed += 1
            if folder.is_dir():
                check_not_torn(folder, expected | parts)
                with contextlib.suppress(FileNotFoundError):
                    found = list((folder / "samples").iterdir())
                    killed_at_work += len(found) > 0 and not (folder / "manifest.json").exists()
        else:
            assert contents(folder) == expected
        if (folder / "manifest.json").exists():
            rounds += 1
            folder = tmp_path / str(rounds)
    finish(start(folder))
    assert contents(folder) == expected
    assert killed_at_work >= KILLS // 3, "the kills came too early or too late to mean anything"


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_leftovers_of_a_killed_writer_disappear(reference, tmp_path):
    expected, parts, _ = reference
    for name, data in parts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    leftover = tmp_path / "samples/.tmp-elsewhere-123-lam_0001.usdc"
    leftover.write_bytes(b"half")
    long_ago = time.time() - 7200.0
    os.utime(leftover, (long_ago, long_ago))
    (tmp_path / "samples/lam_0001.usdc.sha256").write_text("0  lam_0001.usdc\n")
    finish(start(tmp_path))
    assert contents(tmp_path) == expected
