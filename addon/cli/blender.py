# SPDX-License-Identifier: GPL-3.0-or-later
"""Loading what may bring Blender along, without letting it write into our output."""

import atexit
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn


@contextmanager
def quiet() -> Iterator[None]:
    """Blender reports what it does on standard output, which belongs to our JSON."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def leave(status: int) -> NoReturn:
    """Ends the process. bpy 4.5 may never return from its static destructors, which wait for a thread that nobody ends.
    With bpy loaded they are therefore left out, after everything that Python itself has to clean up."""
    if "bpy" not in sys.modules:
        sys.exit(status)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def load_core() -> None:
    """The compiled core, and bpy where it is installed (it must come first). Raises NativeError."""
    from .. import native

    with quiet():
        native.check()
