# SPDX-License-Identifier: GPL-3.0-or-later
"""The group of commands: each command's module adds itself to it."""

import click

from ..version import VERSION


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(VERSION, prog_name="stormfield")
def cli() -> None:
    """Vector fields on surfaces that change over time.

    FIELD is a .t or .ply data set, a baked cache folder, any point data that meshio reads, or wind on a
    latitude-longitude grid (.npz, NetCDF), which is put onto a sphere.
    """
