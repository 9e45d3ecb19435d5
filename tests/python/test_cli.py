# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line is a contract: names, JSON, exit statuses, one line per fault."""

import json
import os
import signal
import subprocess
import sys
import time

import meshio
import numpy as np
import pytest
from command_line import refused, run
from stormfield import native
from stormfield.cache import store
from stormfield.cache.field_cache import open_cache
from stormfield.cli.bake import _frames
from stormfield.model.errors import InputError
from stormfield.readers.icosphere import icosphere
from test_cache import contents

MESH_KEYS = {"vertices", "faces", "components", "boundary_loops", "euler_characteristic"}


@pytest.fixture(scope="module")
def sphere(tmp_path_factory):
    """A rotation about z on a sphere, as .ply with vectors in nx, ny, nz."""
    mesh = icosphere(1280)
    vectors = np.cross([0.0, 0.0, 1.0], mesh.vertices) + 0.2 * (
        np.array([0, 0, 1.0]) - mesh.vertices[:, 2:] * mesh.vertices
    )
    data = {name: vectors[:, k] for k, name in enumerate(("nx", "ny", "nz"))}
    path = tmp_path_factory.mktemp("data") / "sphere.ply"
    meshio.write(path, meshio.Mesh(mesh.vertices, [("triangle", mesh.triangles)], point_data=data), binary=False)
    return path


@pytest.fixture
def design(tmp_path, sphere):
    """A design file with its mesh beside it, and a function that changes it."""

    def write(**changes):
        content = {
            "schema": "stormfield.design/1",
            "mesh": {"file": os.path.relpath(sphere, tmp_path)},
            "settings": {"samples": 4},
            "elements": [
                {"name": "eye", "type": "singular", "kind": "vortex_ccw", "points": [[0, 0, 1]], "radius": 0.4},
                {"name": "tail", "type": "singular", "kind": "sink", "points": [[0, 0, -1]], "radius": 0.4},
            ],
        }
        content.update(changes)
        path = tmp_path / "design.json"
        path.write_text(json.dumps(content))
        return path

    return write


# info and analyze -----------------------------------------------------------------------------------------------------


def test_info(capsys, sphere):
    status, out, err = run(capsys, "info", sphere)
    content = json.loads(out)
    assert status == 0 and err == (
        f"read: {sphere}: nx (points, 1 component), ny (points, 1 component), nz (points, 1 component); "
        "tangent share 1\n"
    )
    assert content["schema"] == "stormfield.info/1"
    assert content["read"]["files"] == [str(sphere)]
    assert [array["name"] for array in content["read"]["arrays"]] == ["nx", "ny", "nz"]
    assert content["mesh"] == {
        "vertices": 642, "faces": 1280, "components": 1, "boundary_loops": 0, "euler_characteristic": 2
    }  # fmt: skip
    assert content["seconds"].keys() == {"read", "mesh"} and content["lam"] == [0.0]


def test_info_of_a_mesh_without_a_field(capsys, tmp_path):
    bare = tmp_path / "bare.obj"
    bare.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    status, out, _ = run(capsys, "info", bare)
    content = json.loads(out)
    assert status == 0 and content["lam"] == []
    assert content["mesh"]["faces"] == 1 and content["mesh"]["boundary_loops"] == 1


def test_analyze(capsys, sphere, tmp_path):
    status, out, _ = run(capsys, "analyze", sphere, "--json", tmp_path / "a.json")
    content = json.loads((tmp_path / "a.json").read_text())
    assert (status, out) == (0, "")
    assert content.keys() == {
        *("schema", "read", "mesh", "lam", "seconds", "index_sum", "boundary_index_sum", "zero_regions"),
        *("fixed_points", "boundary_points", "periodic_orbits", "separatrices", "links"),
    }
    assert content["mesh"].keys() == MESH_KEYS
    assert content["index_sum"] == sum(point["index"] for point in content["fixed_points"]) == 2
    found = {point["kind"]: point["position"] for point in content["fixed_points"]}
    assert found.keys() == {"source", "sink"}
    assert np.allclose(found["source"], [0, 0, -1], atol=0.01)
    assert np.allclose(found["sink"], [0, 0, 1], atol=0.01)
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_analyze_a_cache_at_lambda(capsys, design, tmp_path):
    assert run(capsys, "solve", design(), "--out", tmp_path / "out")[0] == 0
    status, out, _ = run(capsys, "analyze", tmp_path / "out", "--lam", "0.4", "--json", "-")
    assert status == 0
    assert json.loads(out)["lam"] == 0.4 and json.loads(out)["index_sum"] == 2
    assert "sf_twist" in refused(capsys, "analyze", tmp_path / "out", "--attribute", "sf_twist", "--json", "-")


# solve ----------------------------------------------------------------------------------------------------------------


def test_solve_writes_the_cache_and_a_report(capsys, design, tmp_path):
    status, out, err = run(capsys, "solve", design(), "--out", tmp_path / "out", "--json", "-")
    report = json.loads(out)
    assert status == 0 and err.startswith("read: ") and err.count("\n") == 1
    assert report["schema"] == "stormfield.solve/1" and report["mesh"].keys() == MESH_KEYS
    assert report["seconds"].keys() == {"read", "solve"}
    assert np.allclose(report["lam"], [0, 1 / 3, 2 / 3, 1])
    assert np.allclose(open_cache(tmp_path / "out").lambdas, report["lam"])


def test_solve_again_gives_the_same_bytes(capsys, design, tmp_path):
    run(capsys, "solve", design(), "--out", tmp_path / "out")
    before = contents(tmp_path / "out")
    (tmp_path / "out/field.usdc").unlink()
    assert run(capsys, "solve", design(), "--out", tmp_path / "out", "--resume")[0] == 0
    assert contents(tmp_path / "out") == before
    assert run(capsys, "solve", design(), "--out", tmp_path / "out")[0] == 0
    assert contents(tmp_path / "out") == before


TETRAHEDRON = {
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
}


def test_the_mesh_may_stand_in_the_design(capsys, design, tmp_path):
    top = [{"name": "eye", "type": "singular", "kind": "source", "points": [[0, 0, 1]], "radius": 0.4}]
    assert run(capsys, "solve", design(mesh=TETRAHEDRON, elements=top), "--out", tmp_path / "out")[0] == 0
    assert len(open_cache(tmp_path / "out").mesh.vertices) == 4
    assert "another mesh" in refused(capsys, "solve", design(), "--out", tmp_path / "out")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"schema": "stormfield.design/9"}, "schema"),
        ({"elements": []}, "no element"),
        ({"elements": [{"name": "x", "type": "singular"}]}, "is missing"),
        ({"elements": [{"name": "x", "type": "regular", "points": [[0, 0, 1]], "lam": [2]}]}, "element 'x'"),
        ({"elements": [{"name": "far", "type": "singular", "points": [[9, 0, 0]]}]}, "far"),
        ({"mesh": {"file": "gone.ply"}}, "gone.ply"),
        ({"mesh": {"vertices": [[0, 0, 0]], "triangles": []}}, "empty"),
        ({"mesh": {"vertices": TETRAHEDRON["vertices"], "triangles": [[0, 1, 9]]}}, "9"),
        ({"mesh": None}, "mesh"),
    ],
)
def test_bad_designs_are_refused(capsys, design, tmp_path, changes, words):
    assert words in refused(capsys, "solve", design(**changes), "--out", tmp_path / "out")


# Faults ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["info", "nowhere.t"], "no such file"),
        (["info"], "FIELD"),
        (["frobnicate"], "frobnicate"),
        (["analyze", "SPHERE"], "--json"),
        (["analyze", "SPHERE", "--lam", "1.5", "--json", "-"], "outside 0..1"),
        (["analyze", "SPHERE", "--lam", "soon", "--json", "-"], "soon"),
        (["analyze", "SPHERE", "--vector", "a,b,c", "--json", "-"], "no array 'a'"),
        (["analyze", "SPHERE", "--json", "/nowhere/x.json"], "cannot be written"),
        (["solve", "SPHERE", "--out", "x"], "JSON"),
        (["bake", "nowhere.blend"], "no such file"),
        (["bake", "SPHERE", "--targets", "usd,gif"], "gif"),
        (["bake", "SPHERE", "--frames", "9-1"], "exchange"),
    ],
)
def test_user_faults_are_one_line(capsys, sphere, arguments, words):
    assert words in refused(capsys, *(str(sphere) if word == "SPHERE" else word for word in arguments))


def test_faults_of_the_disk(capsys, design, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    assert "is a file" in refused(capsys, "solve", design(), "--out", tmp_path / "file")

    def full(path):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(store, "_sync", full)
    assert "the disk is full" in refused(capsys, "solve", design(), "--out", tmp_path / "out")


def test_a_missing_or_wrong_core_is_one_line(capsys, sphere, monkeypatch):
    def missing():
        raise native.NativeError("The compiled core is missing: install the wheel")

    monkeypatch.setattr(native, "check", missing)
    assert "install the wheel" in refused(capsys, "info", sphere)


def test_our_own_mistakes_are_not_called_the_users(capsys, design, tmp_path, monkeypatch):
    monkeypatch.setattr("stormfield.bake.lambda_cache.solve_steps", lambda *a, **k: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run(capsys, "solve", design(), "--out", tmp_path / "out")


def test_help_and_version(capsys):
    assert run(capsys, "--help")[0] == 0
    status, out, _ = run(capsys, "--version")
    assert status == 0 and "stormfield" in out


@pytest.mark.parametrize(("text", "frames"), [("3-5", {3, 4, 5}), ("7", {7}), ("-2-1", {-2, -1, 0, 1})])
def test_frame_ranges(text, frames):
    assert _frames(text) == frames


@pytest.mark.parametrize("text", ["", "a", "1-", "1,2", "5-4"])
def test_bad_frame_ranges(text):
    with pytest.raises(InputError):
        _frames(text)


# Interruption ---------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT")
def test_an_interrupted_solve_says_so_and_can_be_resumed(design, tmp_path):
    path = design(settings={"samples": 3000})
    command = [sys.executable, "-m", "stormfield", "solve", str(path), "--out", str(tmp_path / "out")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    while not list((tmp_path / "out").glob(".tmp-*field.usdc")):  # the solve is done, samples are written
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert err.splitlines()[-1].startswith("stormfield: cancelled") and "Traceback" not in err
    assert not [name for name in contents(tmp_path / "out") if ".tmp-" in name or name == "manifest.json"]
