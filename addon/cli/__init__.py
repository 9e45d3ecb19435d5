"""The command line: `stormfield`, or `python -m stormfield`; from Blender, main([...]).

Exit status: 0 done, 1 our fault, 2 user fault (one line on standard error: what, where, cure), 130 cancelled.
Modules are imported inside the commands, so that --help is quick and Blender is loaded only where it is needed.
"""

from collections.abc import Sequence
from typing import NoReturn

import click

from ..version import VERSION
from .blender import leave
from .faults import as_exit_status


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(VERSION, prog_name="stormfield")
def cli() -> None:
    """Vector fields on surfaces that change over time.

    FIELD is a .t or .ply data set, a baked cache folder, any point data that meshio reads, or wind on a
    latitude-longitude grid (.npz, NetCDF), which is put onto a sphere.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit status."""
    return as_exit_status(lambda: cli.main(arguments, prog_name="stormfield", standalone_mode=False))


def run() -> NoReturn:
    """The console script: main(), and out of the process."""
    status = main()
    leave(status)


from . import analyze, bake, info, morse, solve, track  # noqa: E402, F401  (each adds its command to the group)
