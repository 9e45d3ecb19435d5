# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed of the cache as ratios (make bench): baking over copying the same bytes, scrubbing over a bare foreach_set.

python -m pytest -s tests/benchmarks/bench_bake.py (settings in tests/benchmarks/pytest.ini)

Where a scrubbed frame goes (processor time, 100k vertices, 4 attributes, machine with other work): 1.8 to 2.0 ms with a
modifier that reads nothing, which is Blender evaluating a mesh of that size; 2.2 to 3.5 ms with all attributes, so
0.5 to 1.5 ms are the reading and blending of samples, about 0.2 ms per attribute. Between 5 and 40 samples there is
little difference. A frame's wall time under load is several times that.
"""

import shutil
import statistics
import time

try:
    import bpy
except ImportError:
    bpy = None

import numpy as np
import pytest
from stormfield.cache.field_cache import FieldCacheWriter, open_cache
from stormfield.cache.layout import PRIM
from stormfield.cache.store import _sync
from stormfield.cache.usd import usd
from stormfield.model.mesh_data import MeshData
from stormfield.model.polygons import Polygons
from stormfield.work import run

VERTICES, SAMPLES = 100_000, 40


def grid(vertices):
    """A square of quads: mesh with its triangles, and the quads."""
    n = round(vertices**0.5)
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=1).astype(np.int32)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(n * n)], axis=1)
    mesh = MeshData(points.astype(np.float32), np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    return mesh, Polygons(np.full(len(quads), 4, np.int32), quads.ravel())


def sample(mesh, seed):
    rng = np.random.default_rng(seed)
    n = len(mesh.vertices)
    vectors = {name: rng.normal(size=(n, 3)).astype(np.float32) for name in ("sf_orientation", "sf_advection")}
    return vectors | {name: rng.normal(size=n).astype(np.float32) for name in ("sf_speed", "sf_stream")}


def seconds(work):
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def bake(folder, mesh, polygons, samples):
    writer = FieldCacheWriter(folder, mesh, np.linspace(0, 1, len(samples)).tolist(), {}, polygons=polygons)
    for j in writer.missing():
        writer.write_sample(j, samples[j])
    assert run(writer.finish())


def copy(source, target, durable):
    for path in sorted(source.rglob("*")):
        if path.is_file():
            copied = target / path.relative_to(source)
            copied.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copied)
            if durable:
                _sync(copied)
                _sync(copied.parent)


def bake_over_copy(folder, mesh, polygons, samples):
    usd()  # loading USD is no part of a bake
    baked = seconds(lambda: bake(folder / "cache", mesh, polygons, samples))
    plain = seconds(lambda: copy(folder / "cache", folder / "plain", durable=False))
    durable = seconds(lambda: copy(folder / "cache", folder / "durable", durable=True))
    size = sum(path.stat().st_size for path in (folder / "cache").rglob("*") if path.is_file())
    print(f"\nbake: {len(mesh.vertices)} vertices x {len(samples)} samples, {size / 1e6:.0f} MB")
    print(f"  bake            {baked:7.3f} s  {size / 1e6 / baked:6.0f} MB/s")
    print(f"  file copy       {plain:7.3f} s  bake / copy         {baked / plain:5.2f}")
    print(f"  with fsync      {durable:7.3f} s  bake / durable copy {baked / durable:5.2f}")
    cache = open_cache(folder / "cache")
    read = seconds(lambda: [cache.sample(j) for j in range(len(samples))])
    print(f"  read, checked   {read:7.3f} s  {size / 1e6 / read:6.0f} MB/s")


def scrub_over_foreach_set(folder, mesh, polygons, samples, steps=40):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    data = bpy.data.meshes.new("grid")
    data.from_pydata(mesh.vertices.tolist(), [], polygons.indices.reshape(-1, 4).tolist())
    obj = bpy.data.objects.new("grid", data)
    bpy.context.collection.objects.link(obj)
    scene = bpy.context.scene
    scene.frame_end = steps

    empty = median_frame(scene, obj, steps, lambda frame: obj.data.update_tag())

    def set_attributes(frame):
        for name, values in samples[frame % len(samples)].items():
            kind = "FLOAT_VECTOR" if values.ndim == 2 else "FLOAT"
            attribute = data.attributes.get(name) or data.attributes.new(name, kind, "POINT")
            attribute.data.foreach_set("vector" if values.ndim == 2 else "value", values.ravel())
        data.update_tag()

    bare = median_frame(scene, obj, steps, set_attributes)
    for name in samples[0]:
        data.attributes.remove(data.attributes[name])
    bpy.ops.cachefile.open(filepath=str(folder / "cache" / "field.usdc"))
    cache_file = bpy.data.cache_files[0]
    modifier = obj.modifiers.new("cache", "MESH_SEQUENCE_CACHE")
    modifier.cache_file, modifier.object_path, modifier.read_data = cache_file, PRIM, {"ATTRIBUTES"}
    cache_file.override_frame = True
    driver = cache_file.driver_add("frame").driver
    driver.expression = f"frame * 1000 / {steps}"
    first = median_frame(scene, obj, steps, lambda frame: None)
    scrub = median_frame(scene, obj, steps, lambda frame: None)
    modifier.read_data = set()
    nothing = median_frame(scene, obj, steps, lambda frame: None)
    print(f"\nscrub: {len(mesh.vertices)} vertices, 4 attributes, between samples")
    print(f"  frame change alone {1e3 * empty:7.2f} ms")
    print(f"  cache, none read   {1e3 * nothing:7.2f} ms")
    print(f"  with foreach_set   {1e3 * bare:7.2f} ms")
    print(f"  cache, first pass  {1e3 * first:7.2f} ms  cache / foreach_set {first / bare:5.2f}")
    print(f"  cache, again       {1e3 * scrub:7.2f} ms  cache / foreach_set {scrub / bare:5.2f}")


def median_frame(scene, obj, steps, change):
    """Seconds of one frame, with the evaluated attributes at hand; the first frames open files and do not count."""
    times = []
    for frame in range(1, steps + 1):
        began = time.perf_counter()
        change(frame)
        scene.frame_set(frame)
        obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes.get("sf_speed")
        times.append(time.perf_counter() - began)
    return statistics.median(times[steps // 4 :])


@pytest.fixture(scope="module")
def setting(tmp_path_factory):
    """Folder, mesh, polygons, samples."""
    mesh, polygons = grid(VERTICES)
    folder = tmp_path_factory.mktemp("bake")
    yield folder, mesh, polygons, [sample(mesh, j) for j in range(SAMPLES)]
    shutil.rmtree(folder)


def bench_cache(setting):
    bake_over_copy(*setting)


def bench_lambda(setting):
    if bpy is None:
        pytest.skip("scrubbing needs bpy")
    scrub_over_foreach_set(*setting)
