# SPDX-License-Identifier: GPL-3.0-or-later
"""The console script stormfield, and python -m stormfield: one command, then out of the process."""

from typing import NoReturn

from . import register
from .cli import main
from .cli.blender import leave


def run() -> NoReturn:
    leave(main(register=register))


if __name__ == "__main__":
    run()
