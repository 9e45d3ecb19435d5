# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library: what is in it works, and Blender knows it while the extension is enabled."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """Built as the zip's, by this Blender."""
    folder = tmp_path_factory.mktemp("assets")
    done = subprocess.run(
        [sys.executable, str(ROOT / "scripts" / "build_assets.py"), str(folder)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "stormfield.blend"


def append(library):
    with bpy.data.libraries.load(str(library), assets_only=True) as (there, here):
        here.materials, here.node_groups, here.objects = there.materials, there.node_groups, there.objects
    return here


def test_everything_is_described_in_a_catalog_and_whole(library):
    found = append(library)
    assert {material.name for material in found.materials} >= {"Storm Clouds", "Lava"}
    assert len(found.node_groups) == 6 and len(found.objects) == 10
    catalogs = (library.parent / "blender_assets.cats.txt").read_text()
    for asset in (*found.materials, *found.node_groups, *found.objects):
        data = asset.asset_data
        assert data is not None and data.description and data.catalog_id in catalogs and data.license == "CC0"
        tree = getattr(asset, "node_tree", asset if isinstance(asset, bpy.types.NodeTree) else None)
        if tree is not None:
            assert all(link.is_valid for link in tree.links) and "NodeUndefined" not in {
                n.bl_idname for n in tree.nodes
            }
    pictured = [
        asset for asset in (*found.materials, *found.objects) if asset.preview and any(asset.preview.image_size)
    ]
    assert len(pictured) == len(found.materials) + len(found.objects)


def test_an_element_from_the_library_knows_what_it_is(library, ball):
    jet = next(obj for obj in append(library).objects if obj.name == "Jet")
    bpy.context.scene.collection.objects.link(jet)
    bpy.ops.object.select_all(action="DESELECT")
    jet.select_set(True)
    bpy.context.view_layer.objects.active = ball
    assert bpy.ops.stormfield.add_elements(type="singular") == {"FINISHED"}
    element = ball.stormfield.elements[-1]
    assert (element.type, element.source) == ("streamline", jet) and element.strength == pytest.approx(0.5)


@pytest.fixture
def turning(ball, put_field):
    """The ball with a solid rotation about z, one radian a second."""
    put_field(ball, lambda places: np.cross([0.0, 0.0, 1.0], places))
    return ball


def evaluated(obj, group):
    modifier = obj.modifiers.get("Flow") or obj.modifiers.new("Flow", "NODES")
    modifier.node_group = group
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()  # to be kept while it is read


def positions(geometry):
    data = geometry.attributes["position"].data
    found = np.empty(3 * len(data), np.float32)
    data.foreach_get("vector", found)
    return found.reshape(-1, 3)


def test_streamlines_follow_the_field_on_the_surface(library, turning):
    group = next(g for g in append(library).node_groups if g.name == "Stormfield Streamlines")
    made = evaluated(turning, group)
    lines = positions(made.curves).reshape(len(made.curves.curves), -1, 3)
    assert len(lines) > 100
    assert np.abs(np.linalg.norm(lines, axis=2) - 1.0).max() < 0.01
    steps = np.diff(lines, axis=1)
    assert np.median(np.linalg.norm(steps, axis=2)) == pytest.approx(0.5 / 16, rel=0.03)
    along = np.cross([0.0, 0.0, 1.0], lines[:, :-1])
    cosine = np.einsum("ijk,ijk->ij", steps, along) / np.linalg.norm(steps, axis=2) / np.linalg.norm(along, axis=2)
    away = np.abs(lines[:, :-1, 2]) < 0.9  # from the poles
    assert np.median(cosine[away]) > 0.999


def test_points_travel_as_fast_as_the_field(library, turning, scene):
    group = next(g for g in append(library).node_groups if g.name == "Stormfield Advect Points")
    scene.render.fps = 24
    places = []
    for frame in range(1, 14):
        scene.frame_set(frame)
        made = evaluated(turning, group)
        places.append(positions(made.pointcloud))
    first, last = places[0], places[-1]
    assert len(first) == len(last) > 100
    assert np.abs(np.linalg.norm(last, axis=1) - 1.0).max() < 0.01
    turned = np.arctan2(last[:, 1], last[:, 0]) - np.arctan2(first[:, 1], first[:, 0])
    turned = (turned + np.pi) % (2 * np.pi) - np.pi
    assert np.median(turned[np.abs(first[:, 2]) < 0.9]) == pytest.approx(12 / 24, rel=0.05)


def test_blender_knows_the_library_while_the_extension_is_on(library, monkeypatch):
    from stormfield import assets

    libraries = bpy.context.preferences.filepaths.asset_libraries

    def ours():
        return [entry for entry in libraries if entry.path and Path(entry.path) == library.parent]

    monkeypatch.setattr(assets, "FOLDER", library.parent)
    for _ in range(2):  # Blender keeps preferences between two starts
        assets.register()
    assert len(ours()) == 1 and ours()[0].name == "Stormfield"
    ours()[0].name = "Mine"
    assets.unregister()
    assert not ours()


def test_without_its_file_there_is_no_library(tmp_path, monkeypatch):
    from stormfield import assets

    monkeypatch.setattr(assets, "FOLDER", tmp_path)
    before = len(bpy.context.preferences.filepaths.asset_libraries)
    assets.register()
    assert len(bpy.context.preferences.filepaths.asset_libraries) == before
