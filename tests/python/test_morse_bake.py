# SPDX-License-Identifier: GPL-3.0-or-later
"""Morse sets over λ: one number for one set, whatever moves, appears and goes; and their cache."""

from dataclasses import replace

import numpy as np
import pytest
import stormfield_native as native
from stormfield.bake.job import bake_steps
from stormfield.bake.targets.morse import KIND, KINDS, MORSE, MorseSamples, Sets, continued
from stormfield.bake.task import BakeTask, MorseSettings
from stormfield.cache import fields
from stormfield.cache.field_cache import FieldCacheWriter, open_cache
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.model.polygons import Polygons
from stormfield.readers.icosphere import icosphere
from stormfield.work import run

LAMBDAS = np.linspace(0, 1, 6)
SOURCE, SINK, SADDLE = (KINDS.index(kind) for kind in ("source", "sink", "saddle"))


def square(n=24):
    axis = np.linspace(-1, 1, n + 1)
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    triangles = np.stack([a, b, c, a, c, d], 1).reshape(-1, 3).astype(np.int32)
    return MeshData(np.stack([x, y, 0 * x], 1), triangles), Polygons(
        np.full(n * n, 4, np.int32), np.stack([a, b, c, d], 1).astype(np.int32).ravel()
    )


def drifting(vertices, lam):
    """Two sinks, at x = -0.5 and 0.5, and the saddle between them, all drifting upwards together."""
    x, y = vertices[:, 0] - 0.011, vertices[:, 1] - 0.8 * (lam - 0.5)
    return np.stack([x - 4 * x**3, -y, 0 * x], 1)


def pair(vertices, lam):
    """A saddle and a sink that meet at λ = 0.5 and are gone: x' = 0.2 (0.5 - λ) - (x + 0.013)²."""
    x, y = vertices[:, 0] + 0.013, vertices[:, 1] + 0.017
    return np.stack([0.5 * (0.5 - lam) - x**2, -y, 0 * x], 1)


def write_cache(folder, mesh, polygons, field, lambdas=LAMBDAS):
    writer = FieldCacheWriter(folder, mesh, lambdas, {"design": "of a test"}, polygons=polygons)
    for j, lam in enumerate(lambdas):
        writer.write_sample(j, {fields.ADVECTION: field(mesh.vertices, lam).astype(np.float32)})
    assert run(writer.finish())
    return open_cache(folder)


def samples(cache, mesh, polygons, settings=None):
    morse = MorseSamples(cache, mesh, settings or MorseSettings())
    return [run(morse.steps(j, polygons)) for j in range(len(cache.lambdas))]


def kinds_by_number(sample):
    return {int(n): int(sample[KIND][sample[MORSE] == n][0]) for n in np.unique(sample[MORSE]) if n >= 0}


def test_sets_that_move_keep_their_numbers(tmp_path):
    mesh, polygons = square()
    found = samples(write_cache(tmp_path, mesh, polygons, drifting), mesh, polygons)
    first = kinds_by_number(found[0])
    assert sorted(first.values()) == [SINK, SINK, SADDLE] and sorted(first) == [0, 1, 2]
    assert all(kinds_by_number(sample) == first for sample in found)
    centres = mesh.vertices[polygons.indices.reshape(-1, 4)].mean(axis=1)
    for number in first:
        x = [centres[sample[MORSE] == number, 0].mean() for sample in found]
        y = [centres[sample[MORSE] == number, 1].mean() for sample in found]
        assert np.ptp(x) < 0.1 and y[-1] - y[0] == pytest.approx(0.8, abs=0.1)


@pytest.mark.parametrize("backwards", [False, True])
def test_sets_come_and_go(tmp_path, backwards):
    mesh, polygons = square()
    found = samples(
        write_cache(tmp_path, mesh, polygons, lambda p, lam: pair(p, 1 - lam if backwards else lam)), mesh, polygons
    )
    counts = [len(kinds_by_number(sample)) for sample in found]
    assert counts == ([0, 0, 0, 2, 2, 2] if backwards else [2, 2, 2, 0, 0, 0])
    there = [kinds_by_number(sample) for sample in found if (sample[MORSE] >= 0).any()]
    assert sorted(there[0].values()) == [SINK, SADDLE] and all(kinds == there[0] for kinds in there)


@pytest.mark.parametrize("method", ["tau", "spatial"])
def test_maps_of_the_flow_have_numbers_too(tmp_path, method):
    mesh, polygons = square()
    cache = write_cache(tmp_path, mesh, polygons, drifting, LAMBDAS[:3])
    found = samples(cache, mesh, polygons, MorseSettings(method=method))
    assert sorted(kinds_by_number(found[0]).values()) == [SINK, SINK, SADDLE]
    assert all(kinds_by_number(sample) == kinds_by_number(found[0]) for sample in found)


def test_a_field_that_stands_still_has_no_sets(tmp_path):
    mesh, polygons = square(8)
    cache = write_cache(tmp_path, mesh, polygons, lambda p, lam: drifting(p, 0.5) * min(lam, 1 - lam), [0.0, 0.5, 1.0])
    found = samples(cache, mesh, polygons, MorseSettings(method="tau"))
    assert [bool((sample[MORSE] >= 0).any()) for sample in found] == [False, True, False]


def test_only_one_enclosure_hands_on_and_first_to_the_same_kind():
    #            two sets   their successors, the second in another enclosure
    before = Sets(np.array([0, 0, 1, 1, -1, -1]), np.array([SINK, SADDLE]), np.array([5, 7], np.int32))
    after = Sets(np.array([0, 1, 1, -1, 2, 2]), np.array([SADDLE, SINK, SADDLE]), np.full(3, -1, np.int32))
    around = np.array([0, 0, 0, 0, 1, 1])
    areas, centres = np.ones(6), np.eye(6)[:, :3]
    assert continued(before, after, around, areas, centres).tolist() == [7, 5, -1]
    # Another kind only where the two overlap.
    source = replace(after, kinds=np.array([SOURCE, SINK, SADDLE]))
    assert continued(before, source, around, areas, centres).tolist() == [-1, 5, -1]
    empty = Sets(np.full(6, -1), np.empty(0, np.int32), np.empty(0, np.int32))
    assert continued(empty, after, around, areas, centres).tolist() == [-1, -1, -1]
    assert continued(before, empty, around, areas, centres).tolist() == []


def test_a_polygon_takes_the_first_set_of_its_triangles():
    polygons = Polygons(np.array([3, 5, 4], np.int32), np.zeros(12, np.int32))
    assert polygons.of_triangle_values(np.array([4, -1, 2, 3, -1, -1], np.int32)).tolist() == [4, 2, -1]


@pytest.fixture
def task(tmp_path):
    mesh, polygons = square(12)
    cache = write_cache(tmp_path / "lambda", mesh, polygons, drifting)
    return BakeTask(
        cache=cache.folder, mesh=mesh, frames=(1, 2), lambdas=(0.0, 1.0), root=tmp_path,
        targets=frozenset({"morse"}), polygons=polygons
    )  # fmt: skip


def test_the_cache(task):
    result = run(bake_steps(task))
    cache = open_cache(result.folders["morse"])
    assert result.whole and np.array_equal(cache.lambdas, LAMBDAS)
    for j, sample in enumerate(samples(open_cache(task.cache), task.mesh, task.polygons)):
        read = cache.sample(j)
        assert read.keys() == sample.keys()
        for name, values in sample.items():
            assert read[name].dtype == np.int32 and np.array_equal(read[name], values)
    assert np.array_equal(cache.at(0.3)[MORSE], cache.sample(1)[MORSE])
    whole = (cache.folder / "field.usdc").read_bytes()
    (cache.folder / "manifest.json").unlink()
    (cache.folder / "field.usdc").unlink()
    steps = bake_steps(task)
    while not (cache.folder / "samples/lam_0002.usdc").exists():
        next(steps)
    steps.close()
    kept = (cache.folder / "samples/lam_0002.usdc").stat().st_ino
    steps = bake_steps(task)
    while not (cache.folder / "samples/lam_0003.usdc").exists():
        next(steps)
    assert (cache.folder / "samples/lam_0002.usdc").stat().st_ino == kept
    run(steps)
    assert (cache.folder / "field.usdc").read_bytes() == whole
    other = run(bake_steps(replace(task, morse=MorseSettings(method="tau"))))
    assert other.folders["morse"] != cache.folder


def test_one_machine_of_several_writes_it(task):
    assert not run(bake_steps(replace(task, only=frozenset({2})))).whole
    assert run(bake_steps(replace(task, only=frozenset({1})))).whole


def test_bad_settings(task):
    for settings, says in (
        (MorseSettings(method="magic"), "magic"),
        (MorseSettings(method="tau", tau=-1.0), "tau is -1"),
        (MorseSettings(eps=-1.0), "eps is -1"),
    ):
        with pytest.raises(native.InputError, match=says):
            run(bake_steps(replace(task, morse=settings)))
    writer = FieldCacheWriter(task.root / "bad", task.mesh, [0.0], {}, polygons=task.polygons)
    with pytest.raises(InputError, match="144 polygons"):
        writer.write_sample(0, {MORSE: np.zeros(288, np.int32)})


def test_on_a_sphere_numbers_are_as_many_as_features(tmp_path):
    data = icosphere(1280)
    mesh = MeshData(data.vertices, data.triangles)

    def dipole(p, lam):
        axis = np.array([np.sin(lam), 0.0, np.cos(lam)])
        return axis - p * (p @ axis)[:, None]

    found = samples(write_cache(tmp_path, mesh, None, dipole), mesh, Polygons.of_triangles(mesh.triangles))
    assert all(kinds_by_number(sample) == {0: SINK, 1: SOURCE} or kinds_by_number(sample) == {0: SOURCE, 1: SINK}
               for sample in found)  # fmt: skip
