"""Data sets too large for the repository, and made by others: STORMFIELD_DATA names the folder that holds them.

gasEngineV.t, bunny1V.t, torus1V.t, sphere1.ply, simple_fld2.ply   fields of the thesis, from its authors
gfs_wind_michael_2018.npz                                          10 m wind of the GFS model (NOAA/NCEP, public domain)
"""

import os
from pathlib import Path

import pytest


def data_set(name: str) -> Path:
    """The file of that name; without it the test skips and says what to do."""
    folder = os.environ.get("STORMFIELD_DATA")
    if not folder or not (Path(folder) / name).is_file():
        pytest.skip(f"{name} is not in the folder that STORMFIELD_DATA names; tests/data_sets.py says whose it is")
    return Path(folder) / name
