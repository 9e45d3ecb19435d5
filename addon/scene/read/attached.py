# SPDX-License-Identifier: GPL-3.0-or-later
"""Which caches an object shows.

The Mesh Sequence Cache modifiers are the only record of where the caches are, so a path can be stale in one place only.
"""

from pathlib import Path

import bpy

#: Names of the modifiers.
LAMBDA = "Stormfield λ"
FRAMES = "Stormfield Flow"
MORSE = "Stormfield Morse Sets"
#: The modifier behind all others that turns the vectors with the surface.
TURN = "Stormfield Turn"
#: All caches, in the order they have on the object; and those that follow λ.
NAMES = (LAMBDA, FRAMES, MORSE)
OVER_LAMBDA = (LAMBDA, MORSE)


def attached_folder(obj: bpy.types.Object, name: str) -> Path | None:
    """The folder of the cache that modifier `name` shows, if there is one."""
    file = attached_file(obj, name)
    return None if file is None else file.parent


def attached_file(obj: bpy.types.Object, name: str) -> Path | None:
    """The file that modifier `name` reads, there or not."""
    modifier = obj.modifiers.get(name)
    if modifier is None or modifier.type != "MESH_SEQUENCE_CACHE" or modifier.cache_file is None:
        return None
    return Path(bpy.path.abspath(modifier.cache_file.filepath))
