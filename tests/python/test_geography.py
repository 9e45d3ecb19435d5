# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on the globe."""

import numpy as np
import pytest
from stormfield.readers.geography import Geography

POSITIONS = np.random.default_rng(0).normal(size=(501, 3)) * 6.371e6


def test_places_of_the_axes():
    places = Geography(True).latitude_longitude([[1, 0, 0], [0, 2, 0], [0, 0, 3], [0, -1, 0], [1, 0, -1]])
    assert np.allclose(places, [[0, 0], [0, 90], [90, 0], [0, -90], [-45, 0]], rtol=0, atol=1e-12)


def reversed_rows(positions):
    return positions[::-1].copy()[::-1]


def one_by_one(positions):
    return list(positions)


def far_apart(positions):
    spread = np.empty((len(positions), 40))
    spread[:, 7:10] = positions
    return spread[:, 7:10]


@pytest.mark.parametrize("laid_out", [reversed_rows, one_by_one, far_apart, np.asfortranarray])
def test_places_do_not_depend_on_how_positions_lie_in_memory(laid_out):
    """To the last bit: trackings of the same data are compared."""
    geography = Geography(True)
    assert np.array_equal(geography.latitude_longitude(laid_out(POSITIONS)), geography.latitude_longitude(POSITIONS))
