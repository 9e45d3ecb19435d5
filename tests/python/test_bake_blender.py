# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender itself reads our caches: attributes onto the artist's own n-gon mesh, with no Python in between."""

import numpy as np
import pytest
from stormfield.cache import usd
from stormfield.cache.field_cache import FieldCacheWriter, FrameCacheWriter
from stormfield.cache.layout import STAGE
from stormfield.model.mesh_data import MeshData
from stormfield.model.polygons import Polygons
from stormfield.work import run

bpy = pytest.importorskip("bpy")

LAMBDAS = [0.0, 0.25, 0.5, 1.0]
FRAMES = range(1, 12)


def read(mesh):
    """The artist's mesh: vertices, loop triangles, polygons."""
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    counts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return MeshData(vertices.reshape(-1, 3), triangles.reshape(-1, 3)), Polygons(counts, corners)


def lambda_sample(mesh, lam):
    n = len(mesh.vertices)
    return {
        "sf_advection": np.column_stack([np.full(n, lam), np.arange(n), np.ones(n)]).astype(np.float32),
        "sf_speed": (lam + np.arange(n)).astype(np.float32),
    }


def frame_sample(mesh, frame):
    n = len(mesh.vertices)
    return {
        "sf_phase_a": np.column_stack([np.full(n, frame), np.arange(n), np.zeros(n)]).astype(np.float32),
        "sf_phase_b": np.full((n, 3), -frame, np.float32),
        "sf_blend": np.full(n, frame / 100.0, np.float32),
    }


def write(writer, samples):
    for j in writer.missing():
        writer.write_sample(j, samples[j])
    assert run(writer.finish())
    return writer.folder / STAGE


def attach(obj, name, stage):
    before = set(bpy.data.cache_files)
    bpy.ops.cachefile.open(filepath=str(stage))
    (cache_file,) = set(bpy.data.cache_files) - before
    modifier = obj.modifiers.new(name, "MESH_SEQUENCE_CACHE")
    modifier.cache_file = cache_file
    modifier.object_path = usd.PRIM
    modifier.read_data = {"ATTRIBUTES"}
    return cache_file


def follow_lambda(cache_file, obj):
    cache_file.override_frame = True
    driver = cache_file.driver_add("frame").driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.name = "lam"
    variable.targets[0].id = obj
    variable.targets[0].data_path = '["lam"]'
    driver.expression = "lam * 1000"


def evaluated(obj, name):
    """An attribute of the evaluated mesh, or None."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return None
    width = 3 if attribute.data_type == "FLOAT_VECTOR" else 1
    values = np.empty(len(attribute.data) * width, np.float32)
    attribute.data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, 3) if width == 3 else values


def check(obj, mesh):
    """Between samples of both caches, on the object's own faces."""
    for frame, lam in ((1, 0.0), (3, 0.2), (6, 0.5), (9, 0.8), (11, 1.0)):
        bpy.context.scene.frame_set(frame)
        for name, expected in {**lambda_sample(mesh, lam), **frame_sample(mesh, frame)}.items():
            np.testing.assert_allclose(evaluated(obj, name), expected, atol=1e-4, err_msg=f"{name} at frame {frame}")
    bpy.context.scene.frame_set(4, subframe=0.5)
    np.testing.assert_allclose(evaluated(obj, "sf_phase_b"), -4.5, atol=1e-4)
    result = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert len(result.polygons) == len(obj.data.polygons)
    assert [layer.name for layer in result.uv_layers] == ["UVMap"]
    assert result.materials[0].name == "clouds"


@pytest.fixture
def scene(tmp_path):
    """A sphere of quads and triangles with λ keyed from 0 to 1 over frames 1 to 11, and both caches attached."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    obj = bpy.context.object
    obj.data.materials.append(bpy.data.materials.new("clouds"))
    obj["lam"] = 0.0
    obj.keyframe_insert('["lam"]', frame=1)
    obj["lam"] = 1.0
    obj.keyframe_insert('["lam"]', frame=11)
    action = obj.animation_data.action
    curves = action.fcurves if hasattr(action, "fcurves") else action.layers[0].strips[0].channelbags[0].fcurves
    for point in curves[0].keyframe_points:
        point.interpolation = "LINEAR"
    mesh, polygons = read(obj.data)
    lam = FieldCacheWriter(tmp_path / "lam", mesh, LAMBDAS, {}, polygons=polygons)
    frames = FrameCacheWriter(tmp_path / "frames", mesh, FRAMES, {}, polygons=polygons)
    follow_lambda(attach(obj, "λ", write(lam, [lambda_sample(mesh, x) for x in LAMBDAS])), obj)
    attach(obj, "frames", write(frames, [frame_sample(mesh, x) for x in FRAMES]))
    return obj, mesh, polygons, tmp_path


def test_both_caches_reach_the_artists_own_mesh(scene):
    obj, mesh, _, _ = scene
    check(obj, mesh)


def test_a_saved_file_finds_its_caches_again(scene):
    obj, mesh, _, folder = scene
    name = obj.name
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(folder / "scene.blend"))
    assert all(cache_file.filepath.startswith("//") for cache_file in bpy.data.cache_files)
    check(bpy.data.objects[name], mesh)


def test_a_new_bake_shows_after_the_path_is_set_again(scene):
    obj, mesh, polygons, folder = scene
    bpy.context.scene.frame_set(6)
    assert evaluated(obj, "sf_speed")[0] == pytest.approx(0.5)
    writer = FieldCacheWriter(folder / "lam", mesh, LAMBDAS, {"new": True}, polygons=polygons)
    write(writer, [lambda_sample(mesh, x + 7) for x in LAMBDAS])
    for cache_file in bpy.data.cache_files:
        cache_file.filepath = cache_file.filepath
    bpy.context.scene.frame_set(7)
    bpy.context.scene.frame_set(6)
    assert evaluated(obj, "sf_speed")[0] == pytest.approx(7.5)


def test_other_counts_replace_the_mesh_so_polygons_are_needed(scene):
    """Why the cache holds the artist's polygons: with triangles alone Blender would drop materials and UV layers."""
    obj, mesh, _, folder = scene
    write(FieldCacheWriter(folder / "triangles", mesh, [0.0], {}), [lambda_sample(mesh, 0.0)])
    for modifier in list(obj.modifiers):
        obj.modifiers.remove(modifier)
    attach(obj, "triangles", folder / "triangles" / "field.usdc")
    result = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert len(result.polygons) != len(obj.data.polygons)
