# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the asset library of the extension: stormfield.blend and its catalogs, in a folder.

    python scripts/build_assets.py FOLDER        with a Python that has bpy and stormfield

Materials get a picture rendered by Cycles, elements that of their preset.
"""

from __future__ import annotations

import importlib
import math
import os
import sys
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "addon" / "ui" / "preset_pictures"
FILE = "stormfield.blend"
#: Pixels of a material's picture, and its samples.
SIZE, SAMPLES = 128, 12
#: Catalog → its number, which must stay the same for ever.
CATALOGS = {
    name: uuid.uuid5(uuid.NAMESPACE_URL, f"https://stormfield/{name}") for name in ("Materials", "Nodes", "Elements")
}
MATERIALS = {
    "storm_clouds": "Cloud bands of a gas giant that bend around storms",
    "lava": "Dark crust with glowing cracks, carried by the flow",
    "brushed_stripes": "Brushed metal, stripes along the orientation field",
    "caustic_ripple": "Light on the ground of shallow water",
    "fibres": "Hair or silk, combed along the orientation field",
}


def main(folder: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import stormfield

    if not hasattr(bpy.types.Object, "stormfield"):
        stormfield.register()
    folder.mkdir(parents=True, exist_ok=True)
    assets = [*materials(), *node_groups(), *elements()]
    bpy.data.libraries.write(str(folder / FILE), set(assets), fake_user=True, compress=True)
    lines = ["VERSION 1", *(f"{number}:Stormfield/{name}:Stormfield-{name}" for name, number in CATALOGS.items())]
    (folder / "blender_assets.cats.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(folder / FILE)


def mark(asset: Any, catalog: str, description: str, *tags: str) -> Any:
    asset.asset_mark()
    data = asset.asset_data
    data.catalog_id, data.description = str(CATALOGS[catalog]), description
    data.author, data.license = "Stormfield contributors", "CC0"
    for tag in ("stormfield", "flow", *tags):
        data.tags.new(tag, skip_if_exists=True)
    return asset


def part(name: str) -> Any:
    return importlib.import_module(f"stormfield.{name}")


def materials() -> Iterator[bpy.types.Material]:
    shading = part("shading")
    for identifier, description in MATERIALS.items():
        material = mark(shading.build_material(identifier), "Materials", description, "material")
        set_picture(material, render(material))
        yield material


def node_groups() -> Iterator[bpy.types.NodeTree]:
    groups, flow = part("shading.groups"), part("scene.nodes.surface_flow")
    for made, description in (
        (
            groups.advected_coordinates(),
            "Shader: coordinates that travel with the flow, in two phases, and their weights",
        ),
        (groups.flow_noise(), "Shader: noise that the flow carries, with constant contrast"),
        (groups.phase_blend(), "Shader: blends the two phases of any texture without a loss of contrast"),
        (flow.read_field(), "Geometry Nodes: orientation, advection, speed, stream function and rotation of the field"),
        (flow.streamlines(), "Geometry Nodes: curves along the field at each frame"),
        (flow.advect_points(), "Geometry Nodes: points that travel with the field over the frames"),
    ):
        yield mark(made, "Nodes", description, "nodes")


def elements() -> Iterator[bpy.types.Object]:
    """A short curve for each preset. Add from Selected takes what it means from its mark."""
    presets = part("operators.elements")
    for key, (label, text, settings) in presets.PRESETS.items():
        if key == "MERGE":  # which is drawn: it is no single element
            continue
        curve = bpy.data.curves.new(label, "CURVE")
        curve.dimensions = "3D"
        spline = curve.splines.new("POLY")
        spline.points.add(15)
        for number, point in enumerate(spline.points):
            x = number / 15.0 - 0.5
            bend = 0.12 * math.sin(2.0 * math.pi * x) if settings["type"] != "regular" else 0.0
            point.co = (x, bend, 0.0, 1.0)
        obj = bpy.data.objects.new(label, curve)
        obj[presets.PRESET_MARK] = key
        mark(obj, "Elements", f"{text}. Lay it on the surface, then Elements → Other → From Selected", "element")
        set_picture(obj, read_picture(PICTURES / f"{key.lower()}.png"))
        yield obj


# Pictures -------------------------------------------------------------------------------------------------------------


def set_picture(asset: Any, pixels: np.ndarray) -> None:
    preview = asset.preview_ensure()
    preview.image_size = (pixels.shape[1], pixels.shape[0])
    preview.image_pixels_float.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())


def read_picture(path: Path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return pixels


def render(material: bpy.types.Material) -> np.ndarray:
    """The material on a ball that turns as a planet, beside a lamp."""
    scene: Any = bpy.data.scenes.new("Picture")
    with tempfile.TemporaryDirectory() as temporary:
        parts = part("presets.parts")
        ball = parts.add_icosphere(scene, "Ball", 5)
        places = np.array([vertex.co[:] for vertex in ball.data.vertices])
        ball.data.attributes.new("sf_stream", "FLOAT", "POINT").data.foreach_set("value", 0.12 * places[:, 2])
        around = np.cross([0.0, 0.0, 1.0], places)
        for name in ("sf_orientation", "sf_advection"):
            ball.data.attributes.new(name, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", around.ravel())
        ball.data.materials.append(material)
        parts.add_studio(scene, SIZE, SIZE, SAMPLES)
        parts.add_camera(scene, (0.0, -4.2, 0.8), (0.0, 0.0, 0.0), lens=62.0)
        scene.render.film_transparent = True
        scene.render.filepath = str(Path(temporary) / "picture.png")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        pixels = read_picture(Path(scene.render.filepath))
    bpy.data.scenes.remove(scene)
    return pixels


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 may never return from its destructors
