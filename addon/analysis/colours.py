# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of entities, and of λ on paths."""

from collections.abc import Mapping

import numpy as np

Colours = Mapping[str, tuple[float, float, float]]

#: Thesis colours (RGB 0..1): repelling green, attracting red, saddle blue.
_CLASSIC: Colours = {
    "source": (0.10, 0.75, 0.20),
    "repelling": (0.10, 0.75, 0.20),
    "sink": (0.90, 0.12, 0.10),
    "attracting": (0.90, 0.12, 0.10),
    "saddle": (0.12, 0.30, 0.95),
    "center": (0.95, 0.75, 0.10),
    "degenerate": (0.60, 0.60, 0.60),
    "inflow": (0.45, 0.80, 0.50),
    "outflow": (0.95, 0.50, 0.45),
    "trivial": (0.55, 0.55, 0.55),
    "other": (0.65, 0.25, 0.85),
}
#: The same roles in colours that differ for all eyes too that confuse red and green (Okabe and Ito 2008).
_SAFE: Colours = {
    "source": (0.00, 0.62, 0.45),
    "repelling": (0.00, 0.62, 0.45),
    "sink": (0.84, 0.37, 0.00),
    "attracting": (0.84, 0.37, 0.00),
    "saddle": (0.00, 0.45, 0.70),
    "center": (0.94, 0.89, 0.26),
    "degenerate": (0.60, 0.60, 0.60),
    "inflow": (0.45, 0.78, 0.68),
    "outflow": (0.95, 0.66, 0.45),
    "trivial": (0.55, 0.55, 0.55),
    "other": (0.80, 0.47, 0.65),
}
#: By their names in the preferences.
PALETTES: Mapping[str, Colours] = {"COLOR_BLIND_SAFE": _SAFE, "CLASSIC": _CLASSIC}
#: What pictures and objects of an analysis use.
KIND_COLOURS: Colours = _SAFE
#: λ = 0 … 1 on paths: dark violet, magenta, orange, pale yellow.
RAMP = np.array([(0.27, 0.10, 0.50), (0.72, 0.16, 0.50), (0.96, 0.46, 0.24), (0.99, 0.93, 0.62)])


def lam_colours(lam: np.ndarray) -> np.ndarray:
    """(k, 4) colours of λ in 0..1."""
    at = np.linspace(0.0, 1.0, len(RAMP))
    return np.stack([*(np.interp(lam, at, RAMP[:, c]) for c in range(3)), np.ones(len(lam))], axis=1)
