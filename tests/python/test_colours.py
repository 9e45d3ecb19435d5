# SPDX-License-Identifier: GPL-3.0-or-later
"""The default palette stays apart for colour-blind eyes (simulated after Machado, Oliveira, Fernandes 2009)."""

import itertools

import numpy as np
import pytest
from stormfield.analysis.colours import KIND_COLOURS, PALETTES

#: Linear RGB → what the eye takes it for.
EYES = {
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
    "full colour vision": np.eye(3),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = np.array([0.9505, 1.0, 1.089])


def lab(colour, eye) -> np.ndarray:
    """CIE L*a*b* of an sRGB colour as an eye sees it."""
    srgb = np.array(colour)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    ratio = TO_XYZ @ np.clip(np.array(eye) @ linear, 0.0, 1.0) / WHITE
    f = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def nearest(palette, eye) -> float:
    """Smallest distance between two of the four kinds of fixed points; 2.3 can just be told apart."""
    seen = [lab(palette[kind], eye) for kind in ("source", "sink", "saddle", "center")]
    return min(float(np.linalg.norm(a - b)) for a, b in itertools.combinations(seen, 2))


@pytest.mark.parametrize("eye", EYES)
def test_the_default_palette_stays_apart(eye):
    assert KIND_COLOURS is PALETTES["COLOR_BLIND_SAFE"]
    assert nearest(KIND_COLOURS, EYES[eye]) > 15


def test_the_test_finds_the_fault_of_the_classic_palette():
    assert min(nearest(PALETTES["CLASSIC"], eye) for eye in EYES.values()) < 15


def test_palettes_name_the_same_kinds():
    kinds = [set(palette) for palette in PALETTES.values()]
    assert all(each == kinds[0] for each in kinds)
