# SPDX-License-Identifier: GPL-3.0-or-later
"""Which caches an object shows.

The cache files of its Mesh Sequence Cache modifiers are the only record of where those caches are, so a path can be
stale in one place only. Each carries its sort as a custom property: modifiers and cache files may be renamed.
"""

from pathlib import Path

import bpy

from .folders import absolute

#: Sorts of caches that modifiers show, and the names that their modifiers are given.
LAMBDA = "Stormfield λ"
FRAMES = "Stormfield Flow"
MORSE = "Stormfield Morse Sets"
#: The modifier behind all others that turns the vectors with the surface.
TURN = "Stormfield Turn"
#: All caches, in the order they have on the object; and those that follow λ.
NAMES = (LAMBDA, FRAMES, MORSE)
OVER_LAMBDA = (LAMBDA, MORSE)
#: Custom property of a cache file or a node group: its sort, one of NAMES or TURN; and the types of those modifiers.
SORT = "stormfield_sort"
#: Custom property of scenes and of the cache files that were baked for them: a number, the same for both.
SCENE = "stormfield_scene"
TYPES = frozenset({"MESH_SEQUENCE_CACHE", "NODES"})


def find_modifier(obj: bpy.types.Object, sort: str) -> bpy.types.Modifier | None:
    """The modifier that shows the cache of that sort, or turns the vectors; of several the one of the shown scene."""
    found = modifiers_of(obj, sort)
    own = [modifier for modifier in found if is_of_scene(modifier, bpy.context.scene)]
    return next(iter(own or found), None)


def modifiers_of(obj: bpy.types.Object, sort: str) -> list[bpy.types.Modifier]:
    """Those of that sort, in their order: by what they read, as modifiers may be renamed; by its name where the file is
    of an earlier version or has lost its cache file."""
    modifiers = [modifier for modifier in obj.modifiers if modifier.type in TYPES]
    marked = [m for m in modifiers if (read := _read_by(m)) is not None and read.get(SORT) == sort]
    if marked:
        return marked
    unmarked = (m for m in modifiers if (read := _read_by(m)) is None or read.get(SORT) is None)
    return [modifier for modifier in unmarked if modifier.name == sort][:1]


def is_of_scene(modifier: bpy.types.Modifier, scene: bpy.types.Scene | None) -> bool:
    """Whether it shows what was baked for that scene."""
    read = _read_by(modifier)
    return scene is not None and read is not None and read.get(SCENE) is not None and read[SCENE] == scene.get(SCENE)


def _read_by(modifier: bpy.types.Modifier) -> bpy.types.ID | None:
    """The data-block that a modifier reads: its cache file or its node group."""
    return modifier.cache_file if modifier.type == "MESH_SEQUENCE_CACHE" else modifier.node_group


def attached_folder(obj: bpy.types.Object, sort: str) -> Path | None:
    """The folder of the cache of that sort that the object shows, if there is one."""
    file = attached_file(obj, sort)
    return None if file is None else file.parent


def attached_folders(obj: bpy.types.Object) -> list[Path]:
    """The folders of all caches that the object shows, in any scene."""
    read = [_read_by(modifier) for sort in NAMES for modifier in modifiers_of(obj, sort)]
    return [file_of(file).parent for file in read if file is not None]


def attached_file(obj: bpy.types.Object, sort: str) -> Path | None:
    """The file that the modifier of that sort reads, there or not."""
    modifier = find_modifier(obj, sort)
    if modifier is None or modifier.cache_file is None:
        return None
    return file_of(modifier.cache_file)


def file_of(cache_file: bpy.types.CacheFile) -> Path:
    """Where a cache file lies; paths of linked ones are relative to their library."""
    return absolute(cache_file.filepath, library=cache_file.library)
