# SPDX-License-Identifier: GPL-3.0-or-later
"""What a farm packs that takes the files a .blend file names: Blender's own list, and Blender Asset Tracer."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from stormfield.cli import main

FRAMES = range(1, 7)
ATTRIBUTES = ("sf_orientation", "sf_advection", "sf_speed", "sf_stream", "sf_rotation", "sf_phase_a", "sf_phase_b",
              "sf_blend", "sf_morse", "sf_morse_kind")  # fmt: skip
#: Blender Asset Tracer: release 1 reads .blend files itself; release 2 runs inside of Blender, so that its arguments
#: stand behind those of Blender, and rewrites paths by the program PROGRAM.
PACK = """
import sys
import bpy
import blender_asset_tracer
from blender_asset_tracer.cli import cli_main
program, *words = sys.argv[1:]
bpy.app.binary_path = program
first = ["bat"] if blender_asset_tracer.__version__.startswith("1.") else ["bat", "--"]
sys.argv = [*first, "pack", *words]
cli_main()
"""
PROGRAM = """#!/bin/sh
for expression; do :; done
exec "{python}" -c "import bpy; $expression"
"""


@pytest.fixture
def project(storms, scene, tmp_path, capfd):
    """A project's folder with scene.blend, which shows every cache of a bake over frames 1 to 6."""
    folder = tmp_path / "project"
    folder.mkdir()
    scene.frame_end = FRAMES[-1]
    for frame, lam in ((1, 0.0), (6, 1.0)):
        storms.stormfield.lam = lam
        storms.keyframe_insert("stormfield.lam", frame=frame)
    settings = storms.stormfield.bake
    settings.resolution, settings.voxel_size, settings.period = "256", 0.1, 4
    path = folder / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    capfd.readouterr()
    assert main(["bake", str(path), "--targets", "usd,exr,vdb,morse", "--save"]) == 0
    lines = [line.split("\t") for line in capfd.readouterr().out.splitlines() if line.count("\t") == 2]
    opened(path)
    written = {target: Path(where) for _, target, where in lines}
    show_coordinates(bpy.data.objects["Ball"])
    light_and_camera()
    bpy.ops.wm.save_mainfile()
    return SimpleNamespace(folder=folder, blend=path, written=written)


@pytest.fixture
def project_with_sequences(project):
    """The same, and materials and volumes that name the sequences."""
    show_images(bpy.data.objects["Ball"].active_material, project.written["exr"])
    show_volume(project.written["vdb"])
    bpy.ops.wm.save_mainfile()
    return project


def show_coordinates(obj):
    """The coordinates of the flowing texture as colour."""
    material = bpy.data.materials.new("Flow")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    field = material.node_tree.nodes.new("ShaderNodeAttribute")
    field.attribute_name = "sf_phase_a"
    colour = material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    material.node_tree.links.new(field.outputs["Color"], colour)
    obj.data.materials.append(material)


def show_images(material, folder):
    """The flow map as light, an image sequence."""
    image = bpy.data.images.load(str(folder / "frames" / "frame_0001.exr"))
    image.filepath = bpy.path.relpath(image.filepath)
    image.source, image.colorspace_settings.name = "SEQUENCE", "Non-Color"
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.image_user.frame_duration, texture.image_user.use_auto_refresh = len(FRAMES), True
    links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Emission Color"])
    nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 1.0


def show_volume(folder):
    volume = bpy.data.volumes.new("Band")
    volume.filepath = bpy.path.relpath(str(folder / "frames" / "frame_0001.vdb"))
    volume.is_sequence, volume.frame_duration = True, len(FRAMES)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Band", volume))


def light_and_camera():
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0.0, 0.0, 4.0)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.device = 4, "CPU"
    scene.render.resolution_x = scene.render.resolution_y = 48


def seen(tmp_path):
    """Everything the open scene shows at two frames: attributes of the ball, grids of volumes, pixels."""
    found = {}
    for frame in (2, 5):
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        mesh = bpy.data.objects["Ball"].evaluated_get(depsgraph).data
        for name in ATTRIBUTES:
            found[frame, name] = values(mesh.attributes[name])
        for obj in bpy.data.objects:
            if obj.type == "VOLUME":
                grids = obj.evaluated_get(depsgraph).data.grids
                assert grids.load(), grids.error_message
                found[frame, obj.name] = np.array([grids.frame_filepath[-8:], *sorted(grid.name for grid in grids)])
        found[frame, "pixels"] = rendered(tmp_path / "picture.png")
    return found


def values(attribute):
    width, key, number = {"FLOAT_VECTOR": (3, "vector", np.float32), "FLOAT": (1, "value", np.float32),
                          "INT": (1, "value", np.int32)}[attribute.data_type]  # fmt: skip
    read = np.empty(len(attribute.data) * width, number)
    attribute.data.foreach_get(key, read)
    return read


def rendered(path):
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:])
    bpy.data.images.remove(image)
    return pixels


def opened(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(path))


def different(first, second):
    """What differs."""
    assert first.keys() == second.keys()
    return [key for key in first if not np.array_equal(first[key], second[key])]


def pack(blend, target, tmp_path):
    """Packs a scene by Blender Asset Tracer."""
    program = tmp_path / "blender"
    program.write_text(PROGRAM.format(python=sys.executable))
    program.chmod(0o755)
    words = [program, "--project", blend.parent, blend, target]
    done = subprocess.run(
        [sys.executable, "-c", PACK, *map(str, words)], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (packed,) = target.rglob(blend.name)
    return packed


def test_blender_lists_the_whole_of_each_cache(project):
    listed = {Path(path) for path in bpy.utils.blend_paths(absolute=True)}
    named = {Path(bpy.path.abspath(path)) for paths in bpy.data.file_path_map().values() for path in paths}
    files = {Path(bpy.path.abspath(cache.filepath)) for cache in bpy.data.cache_files}
    assert len(files) == 3 and {path.name for path in files} == {"field.usdc"}
    assert files <= listed and files <= named
    assert all(layers_of(path) == [] for path in files)


def layers_of(path):
    """Other files that a USD file needs."""
    from stormfield.cache.usd import usd

    usd()
    from pxr import Sdf, UsdUtils

    layers, assets, missing = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(str(path)))
    return [layer.realPath for layer in layers if Path(layer.realPath) != path] + list(assets) + list(missing)


def test_a_moved_project_shows_the_same(project_with_sequences, tmp_path):
    project = project_with_sequences
    opened(project.blend)
    before = seen(tmp_path)
    assert before[2, "pixels"].std() > 0.05 and not np.array_equal(before[2, "pixels"], before[5, "pixels"])
    assert (2, "Band") in before
    project.folder.rename(tmp_path / "elsewhere")
    opened(tmp_path / "elsewhere" / project.blend.name)
    assert different(before, seen(tmp_path)) == []


OUTSIDE = pytest.mark.parametrize("outside", [False, True], ids=["beside the scene", "outside the project"])


@OUTSIDE
def test_blender_asset_tracer_packs_caches(project, tmp_path, outside):
    check_packed(project, tmp_path, outside)


def check_packed(project, tmp_path, outside):
    """Packed into another folder, the original taken away, the scene shows the same."""
    pytest.importorskip("blender_asset_tracer")
    blend = project.blend
    if outside:
        blend = project.folder / "shots" / "010" / "scene.blend"
        blend.parent.mkdir(parents=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), relative_remap=True)
    opened(blend)
    before = seen(tmp_path)
    packed = pack(blend, tmp_path / "packed", tmp_path)
    project.folder.rename(tmp_path / "gone")
    opened(packed)
    assert different(before, seen(tmp_path)) == []


@OUTSIDE
def test_blender_asset_tracer_packs_sequences(project_with_sequences, tmp_path, outside):
    check_packed(project_with_sequences, tmp_path, outside)


def test_sequences_are_named_as_folders_while_they_are_shown(project_with_sequences):
    name = "Stormfield Sequences"
    frames = {project_with_sequences.written[target] / "frames" for target in ("exr", "vdb")}

    def named():
        obj = bpy.data.objects.get(name)
        bakes = obj.modifiers[0].bakes if obj is not None else ()
        return {Path(bpy.path.abspath(bake.directory)) for bake in bakes}

    assert named() == frames and not bpy.data.objects[name].users_scene
    opened(project_with_sequences.blend)
    assert named() == frames
    bpy.data.volumes.remove(bpy.data.volumes["Band"])
    bpy.ops.wm.save_mainfile()
    assert named() == {project_with_sequences.written["exr"] / "frames"}
    bpy.data.images.remove(next(image for image in bpy.data.images if image.source == "SEQUENCE"))
    bpy.ops.wm.save_mainfile()
    assert named() == set() and name not in bpy.data.node_groups and name not in bpy.data.meshes
