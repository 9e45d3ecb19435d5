# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled core, checked before anyone uses it. Nothing else imports `stormfield_native`.

from . import native
native.TriangleMesh(vertices, triangles)    # loads the core on first use
native.check()                              # raises NativeError when it cannot be used

Type checkers see the core by its stubs. Modules that name its classes in annotations begin with
`from __future__ import annotations`: an annotation that is evaluated would load the core.
"""

import contextlib
import importlib
import importlib.util
import platform
import re
import sys
from functools import cache
from types import ModuleType
from typing import TYPE_CHECKING

from .model import errors
from .version import VERSION

if TYPE_CHECKING:
    from stormfield_native import *  # noqa: F403

MODULE = "stormfield_native"


class NativeError(ImportError):
    """The compiled core cannot be used; the message says why, and the cure."""


@cache
def load() -> ModuleType:
    """The module `stormfield_native` of this Python and this version of Stormfield."""
    if MODULE not in sys.modules:
        _import_blender_first()
    try:
        module = importlib.import_module(MODULE)
    except ModuleNotFoundError as error:
        if error.name != MODULE:
            raise
        raise NativeError(_missing()) from None
    except ImportError as error:
        raise NativeError(_unloadable(str(error))) from error
    found = getattr(module, "__version__", "without a version")
    if found != VERSION:
        raise NativeError(
            f"The compiled core is version {found}, Stormfield is version {VERSION}: "
            "install both from the same package, and restart"
        )
    module.set_input_error(errors.InputError)
    return module


def load_alone() -> ModuleType:
    """The same in a process that never gets Blender, where bpy may not be imported: in threads other than the main."""
    with contextlib.suppress(ImportError):
        importlib.import_module(MODULE)
    return load()


def check() -> None:
    """Raises NativeError when the core is missing, of another version, or cannot be loaded."""
    load()


if not TYPE_CHECKING:

    def __getattr__(name):
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(load(), name)


def _import_blender_first() -> None:
    """The bpy wheel brings a oneTBB newer than the system's; whichever is loaded first serves both
    (docs/architecture.md, decision 10)."""
    if "bpy" in sys.modules or importlib.util.find_spec("bpy") is None:
        return
    importlib.import_module("bpy")


def _missing() -> str:
    return (
        f"The compiled core is missing: this copy of Stormfield has none for {_here()}. "
        f"{_WHERE}; from source, run make zip"
    )


def _unloadable(reason: str) -> str:
    if "undefined symbol" in reason and "tbb" in reason:
        return (
            "The compiled core was loaded before Blender's own libraries: import bpy before stormfield, and restart "
            "this Python"
        )
    if "Python version mismatch" in reason or "undefined symbol: Py" in reason or "_Py" in reason:
        return f"The compiled core belongs to another Python than {_here()}: {_WHERE}"
    if match := re.match(r"(\S+): cannot open shared object file", reason):
        return (
            f"The compiled core needs the library {match[1]}, which this machine does not have: this copy was built "
            f"for the machine that made it. {_WHERE}"
        )
    if match := re.search(r"version `(GLIBC_[\d.]+)' not found", reason):
        return (
            f"The compiled core needs {match[1]}, newer than this system's C library; the zip runs from glibc 2.28 on"
        )
    return f"The compiled core cannot be loaded on {_here()} ({reason}). {_WHERE}"


def _here() -> str:
    """This machine in the words of the zips: linux-x64, Python 3.13."""
    machine = {"x86_64": "x64", "AMD64": "x64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
    system = {"Linux": "linux", "Darwin": "macos", "Windows": "windows"}.get(platform.system(), platform.system())
    return f"{system}-{machine}, Python {sys.version_info.major}.{sys.version_info.minor}"


#: Where the right copy is.
_WHERE = (
    "Install the zip for your system in Preferences, Get Extensions, Install from Disk: it serves Blender 4.5 "
    "(Python 3.11), Blender 5.2 (3.13) and Python 3.14"
)
