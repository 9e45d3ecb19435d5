# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library of the extension: materials, node groups and example elements in stormfield.blend, to be dragged
from the Asset Browser. scripts/build_assets.py makes the file when the zip is built; without it there is no library.

Blender knows libraries by its preferences alone, in 4.5 as in 5.2, so the folder is entered there.
"""

from pathlib import Path
from typing import Any

import bpy

NAME, FILE = "Stormfield", "stormfield.blend"
FOLDER = Path(__file__).parent


def register() -> None:
    if (FOLDER / FILE).is_file() and _known() is None:
        library = _libraries().new(name=NAME, directory=str(FOLDER))
        _let_append(library)


def unregister() -> None:
    library = _known()
    if library is not None:
        _libraries().remove(library)


def _libraries() -> Any:
    preferences: Any = bpy.context.preferences
    return preferences.filepaths.asset_libraries


def _let_append(library: Any) -> None:
    """Dragging copies into the file, which then stands alone, and copies nothing twice."""
    try:
        library.import_method = "APPEND_REUSE"
    except TypeError:  # Blender 5.2: APPEND itself takes what is there already
        library.import_method = "APPEND"


def _known() -> Any:
    """Our entry in the preferences, by its folder: an artist may have renamed it."""
    return next((library for library in _libraries() if library.path and Path(library.path) == FOLDER), None)
