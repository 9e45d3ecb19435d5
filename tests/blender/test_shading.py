# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: an artist's own of the same name stays, and before any bake they show texture, not one colour."""

import bpy
import numpy as np


def test_an_artists_material_of_the_same_name_is_left_alone(ball):
    own = bpy.data.materials.new("Lava")
    nodes = [node.name for node in own.node_tree.nodes] if own.node_tree else []
    assert bpy.ops.stormfield.apply_material(material="lava") == {"FINISHED"}
    assert ball.active_material != own
    assert [node.name for node in own.node_tree.nodes] == nodes if own.node_tree else not nodes


def test_a_material_that_the_artist_changed_is_shared_as_it_is(ball):
    bpy.ops.stormfield.apply_material(material="lava")
    first = ball.active_material
    first.node_tree.nodes.new("ShaderNodeRGB").name = "Mine"
    ball.active_material = None
    bpy.ops.stormfield.apply_material(material="lava")
    assert ball.active_material == first and "Mine" in first.node_tree.nodes


def test_without_a_bake_noises_take_the_objects_own_coordinates(ball, scene, tmp_path):
    from stormfield.scene.nodes.tree import new_material
    from stormfield.shading.groups import flow_noise

    material, tree = new_material("Noise")
    glow = tree.node("ShaderNodeEmission")
    tree.connect(tree.group(flow_noise())["Value"], glow.inputs["Color"])
    tree.surface(glow)
    ball.data.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0.0, 0.0, 1.5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 32, 32
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.view_settings.view_transform = "Raw"
    render.filepath = str(tmp_path / "noise.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    pixels = np.array(image.pixels[:]).reshape(32, 32, 4)[8:24, 8:24, 0]
    assert pixels.std() > 0.03
