# SPDX-License-Identifier: GPL-3.0-or-later
"""Tracking in windows, joined, is tracking in one piece: for every way to cut, with bifurcations at cuts, and Hopf."""

import itertools
import json
import os
import signal
import sys
import threading

import numpy as np
import pytest
from command_line import refused, run
from data_sets import data_set
from stormfield import native
from stormfield.analysis import stitching, tracking, windows
from stormfield.cli import memory
from stormfield.model.errors import InputError
from stormfield.readers.icosphere import icosphere

if not hasattr(native.load(), "StabilityMargins"):
    pytest.skip("the core is older than these tests; build it: make", allow_module_level=True)


def plane(n=9):
    """A square of triangles with a boundary."""
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([first, first + n, first + n + 1, first + 1], axis=1)
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)


def sphere():
    mesh = icosphere(320)
    return np.array(mesh.vertices), np.array(mesh.triangles)


def tangents_of(mesh, vectors):
    return np.stack([native.VectorField.from_space(mesh, sample).values for sample in vectors])


def followed(mesh, lambdas, tangents):
    return native.tracking(native.ParameterizedField(mesh, np.asarray(lambdas, np.float64), tangents))


def part(mesh, lambdas, tangents, first, last):
    piece = slice(first, last + 1)
    found = windows.window_part(followed(mesh, lambdas[piece], tangents[piece]), mesh, lambdas[piece], tangents[piece])
    return windows.part_from_json(json.loads(json.dumps(windows.part_to_json(found))))


def described(found):
    """Paths and bifurcations as a set: λ to 1e-9, places to 1e-6."""

    def path(p):
        return (
            p.index, p.kind, p.begin, p.end, len(p.lambdas),
            *np.round([p.lambdas[0], p.lambdas[-1], p.strength, p.rotation], 8),
            *np.round([*p.positions[0], *p.positions[-1]], 6),
        )  # fmt: skip

    def event(e):
        of = tuple(path(found.paths[i]) for i in e.paths)
        return (e.kind, e.node, round(e.lam, 9), *np.round(e.position, 6), *of)

    return sorted(map(path, found.paths)), sorted(map(event, found.bifurcations))


def cuts(count):
    """Every way to cut the samples 0 … count − 1 into windows that share one."""
    for size in range(count - 1):
        for inner in itertools.combinations(range(1, count - 1), size):
            yield list(itertools.pairwise([0, *inner, count - 1]))


def roughly(found):
    """The same without what a fixed point in a vertex leaves open: samples at one λ, and the kind of a new node."""
    paths, events = described(found)

    def path(p):
        return (p[0], *p[2:4], *p[5:])

    return sorted(map(path, paths)), sorted((e[0], *e[2:6], *map(path, e[6:])) for e in events if e[0] != "hopf")


def assert_same_however_it_is_cut(points, triangles, vectors, min_life=0.0, describe=described):
    mesh = native.TriangleMesh(points, triangles)
    lambdas = np.linspace(0, 1, len(vectors)) ** 1.5
    tangents = tangents_of(mesh, vectors)
    whole = tracking.from_native(followed(mesh, lambdas, tangents), min_life)
    expected = describe(whole)
    pieces = {(a, b): part(mesh, lambdas, tangents, a, b) for a, b in itertools.combinations(range(len(vectors)), 2)}
    for cut in cuts(len(vectors)):
        found = stitching.joined([(f"{a}-{b}", pieces[a, b]) for a, b in reversed(cut)])
        assert np.array_equal(found.lambdas, lambdas)
        assert describe(tracking.from_native(found.tracking, min_life)) == expected, cut
    return whole


@pytest.mark.parametrize("surface", [plane, sphere])
@pytest.mark.parametrize("seed", range(4))
def test_random_fields(surface, seed):
    points, triangles = surface()
    vectors = np.random.default_rng(seed).normal(size=(5, len(points), 3))
    whole = assert_same_however_it_is_cut(points, triangles, vectors)
    assert {event.kind for event in whole.bifurcations} >= {"creation", "annihilation"}


def lives(found):
    """The same without places, which are open where the field is zero along edges at a cut."""
    paths, events = roughly(found)
    return sorted(p[:5] for p in paths), sorted(e[:2] for e in events)


@pytest.mark.parametrize(("values", "describe"), [((-2, -1, 1, 2), roughly), ((-1, 0, 1), lives)])
@pytest.mark.parametrize("seed", range(8))
def test_whole_numbers_put_points_on_edges_and_vertices_and_bifurcations_at_cuts(seed, values, describe):
    points, triangles = plane(6)
    vectors = np.random.default_rng(seed).choice(np.array(values, float), size=(5, len(points), 3))
    vectors[:, :, 2] = 0
    assert_same_however_it_is_cut(points, triangles, vectors, describe=describe)


@pytest.mark.parametrize("seed", range(3))
def test_persistence_is_judged_on_whole_paths(seed):
    points, triangles = plane(8)
    vectors = np.random.default_rng(seed).normal(size=(6, len(points), 3))
    assert_same_however_it_is_cut(points, triangles, vectors, min_life=0.2)


def hopf(points, traces):
    """A focus at (0.03, 0.05) whose trace goes through the given values."""
    x, y = points[:, 0] - 0.03, points[:, 1] - 0.05
    return np.stack([np.stack([t * x - y, x + t * y, 0 * x], axis=1) for t in traces])


@pytest.mark.parametrize(
    ("traces", "count"),
    [
        ([-0.3, -0.2, -0.005, 0.005, 0.2, 0.3], 1),
        ([-0.3, -0.01, 0.01, -0.01, 0.01, 0.3], 1),
        ([-0.3, 0.0, 0.3, 0.0, -0.3, 0.3], 3),
        ([-0.01, 0.01, -0.01, 0.01, -0.01, 0.01], 0),
        ([0.3, 0.01, -0.01, 0.01, -0.01, 0.3], 0),
        ([-0.01, 0.01, 0.0, 0.0, 0.01, 0.3], 0),
    ],
)
def test_hopf_bifurcations_are_judged_after_joining(traces, count):
    points, triangles = plane(8)
    whole = assert_same_however_it_is_cut(points, triangles, hopf(points, traces))
    assert sum(event.kind == "hopf" for event in whole.bifurcations) == count


def test_windows_of_random_spirals_have_the_same_hopf_bifurcations():
    points, triangles = sphere()
    rng = np.random.default_rng(7)
    around = np.cross([0.1, 0.2, 1.0], points)
    pull = np.array([0.1, 0.2, 1.0]) - points
    vectors = [around + t * pull + 0.05 * rng.normal(size=points.shape) for t in (0.3, -0.2, 0.1, -0.3, 0.02, -0.02)]
    whole = assert_same_however_it_is_cut(points, triangles, np.stack(vectors))
    assert any(event.kind == "hopf" for event in whole.bifurcations)


def test_a_region_without_a_field_is_one_in_all_windows_or_none():
    points, triangles = plane(8)
    vectors = np.random.default_rng(3).normal(size=(4, len(points), 3))
    vectors[:, points[:, 0] < -0.4] = 0.0
    vectors[2:, points[:, 1] < -0.4] = 0.0
    mesh = native.TriangleMesh(points, triangles)
    lambdas, tangents = np.linspace(0, 1, 4), tangents_of(mesh, vectors)
    from stormfield.analysis.no_field import region_without_field

    region = region_without_field(mesh, tangents)
    whole = tracking.from_native(followed(mesh, lambdas, tangents), 0.0, 0.0, region)
    found = stitching.joined([("a", part(mesh, lambdas, tangents, 0, 2)), ("b", part(mesh, lambdas, tangents, 2, 3))])
    assert found.region.to_json() == region.to_json() and found.region.note == region.note
    assert roughly(tracking.from_native(found.tracking, 0.0, 0.0, found.region)) == roughly(whole)
    assert found.zero_vectors == int((tangents == 0.0).sum())


# Command line ---------------------------------------------------------------------------------------------------------


def test_wind_in_windows_is_wind_in_one_piece(capsys, tmp_path):
    wind = data_set("gfs_wind_michael_2018.npz")
    options = ("--sphere-faces", 5000)
    assert run(capsys, "track", wind, *options, "--json", tmp_path / "whole.json")[0] == 0
    whole = json.loads((tmp_path / "whole.json").read_text())
    times = whole["read"]["times"] or whole["lam"]
    ends = [times[0], times[7], times[8], times[20], times[-1]]
    parts = []
    for k, (start, to) in enumerate(itertools.pairwise(ends)):
        parts.append(tmp_path / f"part{k}.json")
        assert run(capsys, "track", wind, *options, "--from", start, "--to", to, "--json", parts[-1])[0] == 0
    assert run(capsys, "stitch", *reversed(parts), "--json", tmp_path / "joined.json")[0] == 0
    joined = json.loads((tmp_path / "joined.json").read_text())
    assert joined.keys() == whole.keys()
    for key in ("schema", "read", "mesh", "lam", "min_life", "min_strength", "zero_vectors", "zero_regions"):
        assert joined[key] == whole[key], key

    def ends_of(content):
        rows = [(p["kind"], *p["ends"], *np.round([*p["samples"][0], *p["samples"][-1]], 6)) for p in content["paths"]]
        return sorted(rows), sorted(
            (e["kind"], *np.round([e["lam"], *e["position"]], 6)) for e in content["bifurcations"]
        )

    assert ends_of(joined) == ends_of(whole) and len(whole["paths"]) > 50
    assert "leave a gap" in refused(capsys, "stitch", parts[0], parts[2], "--json", "-")
    assert "overlap" in refused(capsys, "stitch", parts[0], parts[0], "--json", "-")
    assert "is no window" in refused(capsys, "stitch", tmp_path / "whole.json", "--json", "-")
    assert "no such file" in refused(capsys, "stitch", tmp_path / "gone.json", "--json", "-")
    assert "has no two samples" in refused(
        capsys, "track", wind, *options, "--from", times[3], "--to", times[3], "--json", "-"
    )
    assert "--from" in refused(capsys, "track", wind, *options, "--from", "soon", "--json", "-")


def test_windows_of_other_fields_are_refused():
    points, triangles = plane(6)
    mesh = native.TriangleMesh(points, triangles)
    vectors = np.random.default_rng(0).normal(size=(3, len(points), 3))
    lambdas, tangents = np.linspace(0, 1, 3), tangents_of(mesh, vectors)
    other = part(mesh, lambdas, 2 * tangents, 1, 2)
    with pytest.raises(InputError, match="a and b have other meshes or fields"):
        stitching.joined([("a", part(mesh, lambdas, tangents, 0, 1)), ("b", other)])


def wind_file(folder):
    """A vortex that moves, and noise, at nine times."""
    latitude, longitude = np.arange(-90.0, 91, 10), np.arange(0.0, 360, 10)
    rng = np.random.default_rng(5)
    u, v = rng.normal(size=(2, 9, len(latitude), len(longitude)))
    np.savez(folder / "wind.npz", lat=latitude, lon=longitude, u=u, v=v)
    return folder / "wind.npz"


def without_seconds(path):
    content = json.loads(path.read_text())
    del content["seconds"]
    return content


def found_in(content):
    paths = [(p["kind"], *p["ends"], *np.round([*p["samples"][0], *p["samples"][-1]], 6)) for p in content["paths"]]
    return sorted(paths), sorted((e["kind"], *np.round([e["lam"], *e["position"]], 6)) for e in content["bifurcations"])


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_windows_on_dask_are_one_piece_though_a_worker_dies(capsys, tmp_path):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install distributed")
    wind = wind_file(tmp_path)
    options = ("--sphere-faces", 1280, "--json")
    assert run(capsys, "track", wind, *options, tmp_path / "whole.json")[0] == 0
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        again = (wind, "--windows", 4, "--scheduler", cluster.scheduler_address, *options)
        assert run(capsys, "track", *again, tmp_path / "a.json")[0] == 0

        timer = threading.Timer(0.3, os.kill, (cluster.workers[0].process.pid, signal.SIGKILL))
        timer.start()
        assert run(capsys, "track", *again, tmp_path / "b.json")[0] == 0
        timer.join()
    whole, a, b = (without_seconds(tmp_path / f"{name}.json") for name in ("whole", "a", "b"))
    assert a == b
    assert found_in(a) == found_in(whole) and len(whole["paths"]) > 20
    nowhere = ("--windows", 2, "--scheduler", "tcp://127.0.0.1:9")
    assert "does not answer" in refused(capsys, "track", wind, *nowhere, "--json", "-")


@pytest.mark.parametrize(("samples", "count", "windows"), [(9, 4, 4), (3, 5, 2), (2, 1, 1), (745, 8, 8)])
def test_windows_share_one_sample_and_are_nearly_equal(samples, count, windows):
    from stormfield.cli.dask_windows import windows_of

    found = windows_of(samples, count)
    assert len(found) == windows and found[0][0] == 0 and found[-1][1] == samples - 1
    assert all(a[1] == b[0] for a, b in itertools.pairwise(found))
    assert np.ptp([last - first for first, last in found]) <= 1


# Tables ---------------------------------------------------------------------------------------------------------------


def test_tables_hold_what_the_json_holds(capsys, tmp_path):
    reason = "pyarrow is not installed, or not for this NumPy: pip install pyarrow"
    parquet = pytest.importorskip("pyarrow.parquet", reason=reason, exc_type=ImportError)
    wind = wind_file(tmp_path)
    options = ("--sphere-faces", 1280, "--json", tmp_path / "a.json", "--parquet", tmp_path / "tables")
    assert run(capsys, "track", wind, *options)[0] == 0
    content = json.loads((tmp_path / "a.json").read_text())
    names = ("paths", "samples", "bifurcations")
    paths, samples, events = (parquet.read_table(tmp_path / "tables" / f"{name}.parquet").to_pylist() for name in names)
    assert [(p["name"], p["begin"], p["end"], p["life"]) for p in paths] == [
        (p["name"], *p["ends"], p["life"]) for p in content["paths"]
    ]
    assert [
        (s["path"], s["kind"], s["lam"], s["x"], s["y"], s["z"], s["latitude"], s["longitude"]) for s in samples
    ] == [
        (p["name"], kind, *row, *place)
        for p in content["paths"]
        for row, kind, place in zip(p["samples"], p["kinds"], p["places"], strict=True)
    ]
    assert [[e["lam"], e["kind"], e["paths"], e["latitude"]] for e in events] == [
        [e["lam"], e["kind"], e["paths"], e["latitude"]] for e in content["bifurcations"]
    ]


def test_tables_without_pyarrow_are_refused_before_anything_is_read(capsys, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    line = refused(capsys, "track", tmp_path / "none.nc", "--json", "-", "--parquet", tmp_path / "tables")
    assert "pip install stormfield[parquet]" in line


# Memory ---------------------------------------------------------------------------------------------------------------


def test_samples_that_do_not_fit_into_memory_are_followed_in_windows_and_that_is_said(capsys, tmp_path, monkeypatch):
    wind = wind_file(tmp_path)
    options = ("--sphere-faces", 1280, "--json")
    assert run(capsys, "track", wind, *options, tmp_path / "whole.json")[0] == 0
    whole = without_seconds(tmp_path / "whole.json")
    held = most_samples_at_once(monkeypatch)
    gigabytes = 4.5 * memory.size_of(1, whole["mesh"]["vertices"]) / 1e9
    status, _, err = run(capsys, "track", wind, *options, tmp_path / "small.json", "--memory", gigabytes)
    assert status == 0 and "followed in 3 windows, one after another" in err
    small = without_seconds(tmp_path / "small.json")
    assert found_in(small) == found_in(whole) and small["lam"] == whole["lam"]
    assert max(held) == 4

    for few in (("--windows", 1), ("--windows", 2)):
        line = refused(capsys, "track", wind, *options, "-", "--memory", gigabytes, *few)
        assert "give --windows 3" in line and "GB" in line
    line = refused(capsys, "track", wind, *options, "-", "--memory", gigabytes, "--from", 0, "--to", 1)
    assert "choose a shorter window" in line
    line = refused(capsys, "track", wind, *options, "-", "--memory", gigabytes / 4)
    assert "two samples" in line and "--sphere-faces" in line


def most_samples_at_once(monkeypatch):
    """Numbers of samples that the core gets, as they come."""
    held, field = [], native.ParameterizedField
    monkeypatch.setattr(
        native,
        "ParameterizedField",
        lambda mesh, lambdas, values: held.append(len(lambdas)) or field(mesh, lambdas, values),
    )
    return held


def test_windows_without_dask_go_one_after_another(capsys, tmp_path, monkeypatch):
    from stormfield.cli import dask_windows

    wind = wind_file(tmp_path)
    options = ("--sphere-faces", 1280, "--json")
    assert run(capsys, "track", wind, *options, tmp_path / "whole.json")[0] == 0
    monkeypatch.setattr(dask_windows, "has_dask", lambda: False)
    held = most_samples_at_once(monkeypatch)
    status, _, err = run(capsys, "track", wind, *options, tmp_path / "four.json", "--windows", 4)
    assert status == 0 and "Dask is not installed" in err and held == [3, 3, 3, 3]
    whole, four = (without_seconds(tmp_path / f"{name}.json") for name in ("whole", "four"))
    assert found_in(four) == found_in(whole)
    assert "--windows" in refused(capsys, "track", wind, *options, "-", "--scheduler", "tcp://127.0.0.1:9")


@pytest.mark.parametrize("wrong", [0, -1, "nan", "inf"])
def test_memory_that_is_none_is_refused(capsys, tmp_path, wrong):
    assert "--memory" in refused(capsys, "track", wind_file(tmp_path), "--json", "-", "--memory", wrong)


@pytest.mark.parametrize(
    ("samples", "at_once", "windows"), [(9, 9, 1), (9, 8, 2), (9, 5, 2), (9, 4, 3), (9, 2, 8), (744, 100, 8)]
)
def test_windows_hold_what_fits(samples, at_once, windows):
    from stormfield.cli.dask_windows import windows_of

    count = memory.windows_that_fit(samples, 1000, memory.size_of(at_once, 1000), "a.nc")
    assert count == windows
    assert max(last - first + 1 for first, last in windows_of(samples, count)) <= at_once


def test_free_memory_is_told():
    assert 1e7 < memory.free_memory() < 1e15
