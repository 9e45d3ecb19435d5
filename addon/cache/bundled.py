# SPDX-License-Identifier: GPL-3.0-or-later
"""Python modules that Blender brings, and that nobody else has to have: pxr, openvdb, OpenImageIO.

openvdb = bundled("openvdb")      # raises InputError where there is no Blender that has it
"""

import importlib
import importlib.util
import sys
from functools import cache
from types import ModuleType

from ..model.errors import InputError

#: What each module is for, in words of the message when it is missing.
PURPOSES = {"pxr": "USD caches", "openvdb": "VDB volumes", "OpenImageIO": "EXR flow maps"}


@cache
def bundled(name: str) -> ModuleType:
    """The module: Blender's own where bpy is installed (two copies in one process may crash), else this Python's."""
    if sys.modules.get("bpy") or importlib.util.find_spec("bpy"):
        bpy = importlib.import_module("bpy")
        if name not in sys.modules and hasattr(bpy.utils, "expose_bundled_modules"):
            bpy.utils.expose_bundled_modules()
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(
            f"{PURPOSES[name]} need the Python module {name}, which is not here ({error}); run this in Blender 4.5 or "
            "5.2 from blender.org, which bring it"
        ) from error
