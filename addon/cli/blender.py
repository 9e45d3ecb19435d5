"""Loading what may bring Blender along, without letting it write into our output."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


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


def load_core() -> None:
    """The compiled core, and bpy where it is installed (it must come first). Raises NativeError."""
    from .. import native

    with quiet():
        native.check()
