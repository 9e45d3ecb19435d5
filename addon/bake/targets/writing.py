# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a library of Blender writes: its complaints become OSErrors, as those of Python's own files are."""

import contextlib
import errno
import shutil
from collections.abc import Iterator
from pathlib import Path

#: Bytes of free space below which a failed write is taken for a full disk.
FULL = 1 << 20


@contextlib.contextmanager
def disk_faults(path: Path) -> Iterator[None]:
    """Turns RuntimeErrors of a writing library into OSErrors that name the file."""
    try:
        yield
    except RuntimeError as error:
        full = shutil.disk_usage(path.parent).free < FULL
        raise OSError(errno.ENOSPC if full else errno.EIO, str(error), str(path)) from error
