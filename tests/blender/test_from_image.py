# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials from an image: contrast over time, any image, and what a file keeps."""

import bpy
import numpy as np
import pytest
from stormfield.shading.exemplar import DEVIATION, MIDDLE, exemplar, linear_from_srgb, reduced, usage

BLENDS = (0.0, 0.25, 0.5, 0.75, 1.0)


def rng():
    return np.random.default_rng(5)


def blotches(height=96, width=96):
    """Skewed and coloured: a histogram that no normal distribution has. Smooth enough for pixels to be seen between."""
    noise = rng().normal(size=(height, width))
    for axis in (0, 1, 0, 1):
        noise = sum(np.roll(noise, k, axis) for k in range(-3, 4))
    level = np.exp(1.2 * (noise - noise.mean()) / noise.std())
    level = np.clip(level / np.percentile(level, 99), 0.0, 1.0)
    return np.stack([level, 0.6 * level**0.5, 0.3 * (1.0 - level), np.ones_like(level)], axis=-1)


def new_image(pixels, name="Exemplar", is_float=True):
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    return image


def test_normal_values_are_normal_and_the_table_brings_colours_back():
    pixels = blotches()
    made = exemplar(pixels)
    for k in range(2):  # red and blue depend on each other: there is no third axis
        assert abs(made.normal[..., k].mean() - MIDDLE) < 1e-3
        assert abs(made.normal[..., k].std() / DEVIATION - 1.0) < 0.01
    place = made.normal.astype(np.float64) * (len(made.table) - 1)
    values = [np.interp(place[..., k], np.arange(len(made.table)), made.table[:, k]) for k in range(3)]
    back = made.mean + np.stack(values, axis=-1) @ made.axes
    assert np.abs(back - pixels[..., :3]).mean() < 0.01 * pixels[..., :3].std()
    assert made.opaque


def test_few_colours_become_slopes_and_not_noise():
    pixels = np.ones((64, 64, 4))
    pixels[:, :32, :3] = 0.0
    normal = exemplar(pixels).normal[..., 0]
    rows = np.abs(np.diff(normal, axis=1))
    deviation = np.sqrt(np.average((normal - MIDDLE) ** 2, weights=usage(64, 64)))
    assert abs(deviation / DEVIATION - 1.0) < 0.02
    assert np.median(rows) < 0.2 * DEVIATION


def test_large_images_become_means_of_blocks():
    pixels = rng().random((70, 100, 4))
    small = reduced(pixels, 40)
    assert max(small.shape[:2]) <= 40
    assert np.allclose(small[0, 0], pixels[:3, :3].mean(axis=(0, 1)))
    assert np.allclose(reduced(pixels, 100), pixels)


def flat_card(side=2.0, cells=24):
    """A square whose phases are two other places, with one blend everywhere."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=side)
    obj = bpy.context.object
    points = np.empty(len(obj.data.vertices) * 3, np.float32)
    obj.data.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    values = {
        "sf_phase_a": points + np.array([7.3, 1.1, 0.7]),
        "sf_phase_b": points + np.array([-3.9, 5.2, 2.3]),
        "sf_orientation": np.tile([0.6, 0.8, 0.0], (len(points), 1)),
    }
    for name, vectors in values.items():
        obj.data.attributes.new(name, "FLOAT_VECTOR", "POINT").data.foreach_set(
            "vector", np.asarray(vectors, np.float32).ravel()
        )
    obj.data.attributes.new("sf_blend", "FLOAT", "POINT")
    return obj


def rendered(scene, obj, material, blend, tmp_path, pixels=192):
    """Emitted colours of the card, scene-linear."""
    obj.data.attributes["sf_blend"].data.foreach_set("value", np.full(len(obj.data.vertices), blend, np.float32))
    obj.data.update_tag()
    tree = material.node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    look = next(node for node in tree.nodes if node.type == "GROUP")
    if not any(node.type == "EMISSION" for node in tree.nodes):
        glow = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(look.outputs[0], glow.inputs["Color"])
        tree.links.new(glow.outputs[0], output.inputs["Surface"])
    if scene.camera is None:
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 1.95, (0.0, 0.0, 3.0)
        scene.collection.objects.link(camera)
        scene.camera = camera
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y, render.filter_size = "CYCLES", pixels, pixels, 0.01
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.device = 1, False, "CPU"
    scene.view_settings.view_transform = "Raw"
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = str(tmp_path / f"card-{blend}.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    flat = np.empty(pixels * pixels * 4, np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return flat.reshape(pixels, pixels, 4)[..., :3].astype(np.float64)


def spotlight(height=120, width=160):
    """Another picture in the middle than at the border, and sides that do not fit together."""
    y, x = np.mgrid[0:height, 0:width] / np.array([height, width]).reshape(2, 1, 1)
    level = np.exp(-6.0 * ((x - 0.6) ** 2 + (y - 0.45) ** 2)) * (0.6 + 0.4 * np.sin(40.0 * x) * np.sin(31.0 * y))
    return np.stack([level, level**2, 0.5 * level + 0.2 * x, np.ones_like(level)], axis=-1)


@pytest.mark.parametrize("picture", [blotches, spotlight])
def test_contrast_is_that_of_the_image_at_every_blend(scene, tmp_path, picture):
    from stormfield.shading.from_image import material_from_image

    pixels = picture()
    assert exemplar(pixels).repeats == (picture is blotches)
    # So many tiles that the mean over them is that of all.
    material, remarks = material_from_image(new_image(pixels), 0.4 if picture is blotches else 0.12)
    assert not remarks
    card = flat_card()
    card.data.materials.append(material)
    wanted, mean = pixels[..., :3].std(axis=(0, 1)), pixels[..., :3].mean(axis=(0, 1))
    for blend in BLENDS:
        shown = rendered(scene, card, material, blend, tmp_path)
        contrast = np.linalg.norm(shown.std(axis=(0, 1))) / np.linalg.norm(wanted)
        print(f"blend {blend}: contrast {contrast:.3f}")
        assert 0.95 < contrast < 1.05
        assert np.abs(shown.mean(axis=(0, 1)) - mean).max() < 0.05 * np.linalg.norm(wanted) + 0.01


def test_stripes_lie_across_the_orientation_field(scene, tmp_path):
    from stormfield.shading.from_image import material_from_image

    stripes = np.ones((64, 64, 4))
    stripes[..., :3] = (0.5 + 0.5 * np.sin(np.arange(64) * 2.0 * np.pi / 8.0))[None, :, None]
    material, _ = material_from_image(new_image(stripes), 0.4)
    card = flat_card()
    card.data.materials.append(material)
    shown = rendered(scene, card, material, 0.0, tmp_path)[..., 0]
    down, right = np.gradient(shown)
    # The structure tensor's main direction: that of the gradients, along the field (0.6, 0.8).
    tensor = np.array([[(right * right).mean(), (right * down).mean()], [(right * down).mean(), (down * down).mean()]])
    main = np.linalg.eigh(tensor)[1][:, -1]
    assert abs(main @ (0.6, 0.8)) > np.cos(np.radians(5.0))


@pytest.mark.parametrize(
    "pixels",
    [
        np.full((1, 1, 4), (0.2, 0.4, 0.6, 1.0)),
        np.full((8, 5, 4), (0.2, 0.4, 0.6, 1.0)),
        np.concatenate([blotches(16, 40)[..., :3], rng().random((16, 40, 1))], axis=-1),
    ],
    ids=["one pixel", "one colour", "opacity, not square"],
)
def test_any_image_becomes_a_material(ball, pixels):
    image = new_image(pixels)
    assert bpy.ops.stormfield.material_from_image(image="Exemplar") == {"FINISHED"}
    assert ball.active_material.name == "From Exemplar" and image.name in bpy.data.images
    surface = next(node for node in ball.active_material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    assert surface.inputs["Alpha"].is_linked == (pixels[..., 3].min() < 1.0)


def test_one_colour_is_shown_as_it_is(scene, tmp_path):
    from stormfield.shading.from_image import material_from_image

    material, remarks = material_from_image(new_image(np.full((4, 4, 4), (0.2, 0.4, 0.6, 1.0))), 0.4)
    assert "one colour" in remarks[0]
    card = flat_card(cells=2)
    card.data.materials.append(material)
    assert np.abs(rendered(scene, card, material, 0.5, tmp_path, 16) - (0.2, 0.4, 0.6)).max() < 1e-3


def test_files_of_all_depths_are_read_as_blender_shows_them(ball, tmp_path):
    from stormfield.shading.from_image import still_pixels

    for name, file_format, depth, mode in (
        ("grey.png", "PNG", "8", "BW"),
        ("deep.png", "PNG", "16", "RGB"),
        ("clear.png", "PNG", "8", "RGBA"),
        ("half.exr", "OPEN_EXR", "16", "RGB"),
    ):
        source = np.concatenate([np.full((6, 9, 3), 0.25), np.ones((6, 9, 1))], axis=-1)
        image = new_image(source, name)
        settings = bpy.context.scene.render.image_settings
        settings.file_format, settings.color_depth, settings.color_mode = file_format, depth, mode
        bpy.context.scene.view_settings.view_transform = "Standard"
        image.save_render(str(tmp_path / name))
        bpy.data.images.remove(image)
        read = bpy.data.images.load(str(tmp_path / name))
        pixels, remarks = still_pixels(read)
        assert pixels.shape == (6, 9, 4) and not remarks
        assert np.abs(pixels[..., :3] - 0.25).max() < 0.005, name
        assert bpy.ops.stormfield.material_from_image(filepath=str(tmp_path / name)) == {"FINISHED"}


def test_what_is_no_still_image_is_refused_by_name(ball, tmp_path):
    (tmp_path / "notes.png").write_text("not an image")
    broken = blotches(4, 4)
    broken[0, 0, 0] = np.nan
    new_image(broken, "Broken")
    tiled = bpy.data.images.new("Tiled", 8, 8, tiled=True)
    assert tiled.source == "TILED"
    for settings, reason in (
        ({"image": "Nothing"}, "no image 'Nothing'"),
        ({}, "no image file ''"),
        ({"filepath": str(tmp_path / "gone.png")}, "no image file"),
        ({"filepath": str(tmp_path / "notes.png")}, "notes.png"),
        ({"image": "Broken"}, "'Broken' has pixels that are no numbers"),
        ({"image": "Tiled"}, "'Tiled' is an image of several tiles"),
    ):
        before = len(bpy.data.materials), len(bpy.data.images)
        with pytest.raises(RuntimeError, match=reason):
            bpy.ops.stormfield.material_from_image(**settings)
        assert (len(bpy.data.materials), len(bpy.data.images)) == before


def test_the_file_keeps_all_that_it_needs(scene, tmp_path):
    from stormfield.shading.from_image import material_from_image

    image = new_image(blotches(32, 48))
    material, _ = material_from_image(image, 0.4)
    bpy.data.images.remove(image)
    card = flat_card(cells=4)
    card.name = "Card"
    card.data.materials.append(material)
    before = rendered(scene, card, material, 0.5, tmp_path, 48)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    card = bpy.data.objects["Card"]
    after = rendered(bpy.context.scene, card, card.active_material, 0.5, tmp_path, 48)
    assert np.abs(after - before).max() < 2e-3 and before.std() > 0.05


def test_colours_of_8_bit_files_are_decoded():
    assert np.allclose(linear_from_srgb(np.array([0.0, 0.5, 1.0])), [0.0, 0.21404, 1.0], atol=1e-4)
