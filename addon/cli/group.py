# SPDX-License-Identifier: GPL-3.0-or-later
"""The group of commands: each command's module adds itself to it."""

import click

from ..version import VERSION


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(VERSION, prog_name="stormfield")
def cli() -> None:
    """Vector fields on surfaces that change over time.

    FIELD is a .t data set, a surface with vectors at points or cells in any format of VTK or meshio, a series of them
    (.pvd, XDMF, a folder, "wall_*.vtp"), a baked cache folder, or wind on a latitude-longitude grid (.npz, NetCDF),
    which is put onto a sphere.
    """
