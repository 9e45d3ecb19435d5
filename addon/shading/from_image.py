# SPDX-License-Identifier: GPL-3.0-or-later
"""A material that an image is made into: its tiles, turned by the orientation field and moved by the advection field.

Both phases of the flowing coordinates take four tiles each (shading/tiles.py). They are blended as normal values, whose
distribution that does not change, and turned back into colours of the image by a table (shading/exemplar.py): at every
moment the surface has the colours and the contrast of the image. What it needs is in the file: two small images and
nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np

from ..model.errors import InputError
from ..scene.nodes.tree import Socket, Tree, add_input, group_inputs, new_material, set_outputs
from .exemplar import ENTRIES, LARGEST, MIDDLE, TILE, Exemplar, exemplar, for_interpolation, linear_from_srgb, reduced
from .groups import advected_coordinates
from .tiles import direction, tiles

MARK = "from_image"
KINDS = {
    "MOVIE": "a movie",
    "SEQUENCE": "a sequence of images",
    "TILED": "an image of several tiles",
    "VIEWER": "a render result",
}


def material_from_image(image: bpy.types.Image, size: float) -> tuple[bpy.types.Material, list[str]]:
    """A new material, whose image is `size` mesh units high, and what there is to say about the image.

    Raises InputError, which names the image, for one that has no still pixels."""
    pixels, remarks = still_pixels(image)
    if np.ptp(pixels.reshape(-1, 4), axis=0).max() <= 0.0:
        remarks.append(f"The image '{image.name}' has one colour everywhere, and so has the material")
    made = exemplar(pixels)
    material, tree = new_material(f"From {image.name}")
    look = tree.group(_group(image.name, made), size=size)
    surface = tree.principled(base_color=look["Color"], roughness=0.6)
    if not made.opaque:
        tree.connect(look["Opacity"], surface.inputs["Alpha"])
    tree.surface(surface)
    material["stormfield"] = MARK
    return material, remarks


def still_pixels(image: bpy.types.Image) -> tuple[np.ndarray, list[str]]:
    """Scene-linear RGB and opacity (h, w, 4), and remarks."""
    if image.source in KINDS or image.type in {"RENDER_RESULT", "COMPOSITING"}:
        kind = KINDS.get(image.source, "a render result")
        raise InputError(f"'{image.name}' is {kind}: choose a still image, for example a PNG")
    width, height = np.array(image.size).tolist()
    if width * height == 0 or not len(image.pixels):
        where = f" from '{image.filepath}'" if image.filepath else ""
        raise InputError(
            f"The image '{image.name}' cannot be read{where}: choose another file, or find it with File → External Data"
        )
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    pixels = _rgba(flat.reshape(height, width, image.channels))
    if not np.isfinite(pixels).all():
        raise InputError(f"The image '{image.name}' has pixels that are no numbers: save it again without them")
    remarks = []
    if not image.is_float and image.colorspace_settings.name not in {"Non-Color", "Raw", "Linear Rec.709"}:
        pixels[..., :3] = linear_from_srgb(pixels[..., :3])
    small = reduced(pixels.astype(np.float64))
    if small.shape != pixels.shape:
        remarks.append(
            f"The image '{image.name}' has {width} × {height} pixels; "
            f"the material uses {small.shape[1]} × {small.shape[0]} (at most {LARGEST})"
        )
    return small, remarks


def _rgba(pixels: np.ndarray) -> np.ndarray:
    """Of grey, grey with opacity, RGB or RGBA."""
    channels = pixels.shape[2]
    colours = np.repeat(pixels[..., :1], 3, axis=2) if channels < 3 else pixels[..., :3]
    opacity = pixels[..., -1:] if channels in (2, 4) else np.ones_like(pixels[..., :1])
    return np.concatenate([colours, np.clip(opacity, 0.0, 1.0)], axis=2)


def _group(name: str, made: Exemplar) -> bpy.types.NodeTree:
    """The node group of one image."""
    tree = Tree(bpy.data.node_groups.new(f"From {name}", "ShaderNodeTree"))
    add_input(tree, "Size", 1.0, 1e-6, 1e6, "Length that the image's height takes on the surface, mesh units")
    add_input(
        tree,
        "Tile",
        TILE,
        0.01,
        0.5,
        "Radius of a tile over the shorter side of the image: larger ones keep larger shapes, smaller ones repeat less",
    )
    add_input(tree, "Sharpness", 4.0, 1.0, 32.0, "How narrow the seams are in which tiles blend")
    given = group_inputs(tree)
    height, width = made.normal.shape[:2]
    normal = _data_image(f"{name} normal", for_interpolation(made.normal))
    table = _data_image(f"{name} table", made.table[None])
    carried, turned = tree.group(advected_coordinates()), tree.group(direction())
    total: Socket | None = None
    opacity: Socket | None = None
    for phase in "AB":
        found = tree.group(
            tiles(), coordinate=carried[f"Phase {phase}"], along=turned["Along"], across=turned["Across"],
            size=given["Size"], aspect=width / height, tile=given["Tile"], sharpness=given["Sharpness"],
            margin=0.0 if made.repeats else given["Tile"],
        )  # fmt: skip
        for k in range(1, 5):
            weight = found[f"Weight {k}"] * carried[f"Weight {phase}"]
            values, alpha = tree.image(normal, found[f"Uv {k}"], "Linear", "REPEAT")
            part = (values - (MIDDLE,) * 3).scaled(weight)
            total = part if total is None else total + part
            if not made.opaque:
                piece = (alpha - MIDDLE) * weight
                opacity = piece if opacity is None else opacity + piece
    assert total is not None
    shown: Socket | None = None
    for k, value in enumerate(tree.components(total)):
        found_colour, _ = tree.image(table, _entry(tree, value), "Linear", "EXTEND")
        axis = tree.combine(*made.axes[k].tolist()).scaled(tree.components(found_colour)[k])
        shown = axis + _vector(made.mean) if shown is None else shown + axis
    assert shown is not None
    shown = tree.vector("MAXIMUM", shown, (0.0, 0.0, 0.0))
    if opacity is None:
        set_outputs(tree, color=shown)
    else:
        _, alpha = tree.image(table, _entry(tree, opacity), "Linear", "EXTEND")
        set_outputs(tree, color=shown, opacity=alpha)
    return tree.tree


def _entry(tree: Tree, value: Socket) -> Socket:
    """Where the table has a blended value, given without its mean."""
    place = (value + MIDDLE).clamped() * ((ENTRIES - 1) / ENTRIES) + 0.5 / ENTRIES
    return tree.combine(place, 0.5, 0.0)


def _vector(values: np.ndarray) -> Sequence[float]:
    return tuple(float(v) for v in values)


def _data_image(name: str, values: np.ndarray) -> bpy.types.Image:
    """An image of plain numbers, inside the file."""
    height, width = values.shape[:2]
    image: Any = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(np.ascontiguousarray(values, np.float32).ravel())
    image.update()
    image.pack()
    return image
