# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders of image and volume sequences, named by the .blend file as a whole.

Blender names the first file of a sequence only, and so farms that pack what it names (Blender Asset Tracer 2) leave the
others behind. What it names as a folder is the place of a bake of Geometry Nodes: an object that is in no scene has
such nodes, one for each folder. Nothing evaluates it.
"""

import bpy

from ..read.cache_paths import cache_paths
from ..read.folders import relative

NAME = "Stormfield Sequences"


def name_sequences() -> None:
    """Called just before the file is written, when its caches are where it will look for them. Blender itself keeps
    these paths right when the file is saved elsewhere, as it does with all others."""
    folders = sorted({path.path.parent for path in cache_paths() if _is_sequence(path.block)})
    _remove()
    if folders:
        _add([relative(folder, bpy.data.filepath) for folder in folders])


def _is_sequence(block: bpy.types.ID) -> bool:
    if isinstance(block, bpy.types.Image):
        return block.source == "SEQUENCE"
    return isinstance(block, bpy.types.Volume) and block.is_sequence


def _remove() -> None:
    made = [data.get(NAME) for data in (bpy.data.objects, bpy.data.meshes, bpy.data.node_groups)]
    bpy.data.batch_remove([block for block in made if block is not None])


def _add(folders: list[str]) -> None:
    tree = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    for _ in folders:
        tree.nodes.new("GeometryNodeBake")
    obj = bpy.data.objects.new(NAME, bpy.data.meshes.new(NAME))
    obj.use_fake_user = True
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.node_group = tree
    for bake, folder in zip(modifier.bakes, folders, strict=True):
        bake.use_custom_path, bake.bake_target, bake.directory = True, "DISK", folder
