# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `stormfield`, `python -m stormfield` and `blender -b SCENE --command stormfield`.

Exit status: 0 done, 1 our fault, 2 user fault (one line on standard error: what, where, cure), 130 cancelled.
Modules are imported inside the commands, so that --help is quick and Blender is loaded only where it is needed.
"""

from collections.abc import Callable, Sequence

from . import analyze, bake, edit, import_, info, morse, solve, stitch, track  # noqa: F401  (each adds its command)
from .faults import as_exit_status
from .group import cli


def main(arguments: Sequence[str] | None = None, *, register: Callable[[], None] | None = None) -> int:
    """Runs one command; returns the exit status. register: adds the add-on to a Blender that does not have it yet."""
    return as_exit_status(lambda: cli.main(arguments, prog_name="stormfield", standalone_mode=False, obj=register))
