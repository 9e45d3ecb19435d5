# SPDX-License-Identifier: GPL-3.0-or-later
"""An image made ready for blending without loss of contrast (E. Heitz, F. Neyret, High-Performance By-Example Noise
using a Histogram-Preserving Blending Operator, 2018).

Colours are written along their principal axes, where they are uncorrelated, and each axis is turned into values of a
normal distribution by their order. Values that are blended with weights of squared sum 1 have the same distribution
again, and a table turns them back into colours of the image:

    colour = mean + Σ_k axis_k table_k(blended_k)

Tiles show the middle of an image more often than its border where its sides do not fit together. There each pixel
counts as often as it is shown, so that the surface has the colours of the whole image all the same. Pixels of equal
value are put in order by what surrounds them, so that an image of a few colours becomes smooth slopes and no noise.
No Blender here.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

#: Values are stored around 1/2 with this deviation: 0 to 1 are three deviations to each side.
MIDDLE, DEVIATION = 0.5, 1.0 / 6.0
#: Entries of the table.
ENTRIES = 1024
#: Pixels on the longer side, at most.
LARGEST = 2048


#: Radius of tiles over the shorter side of the image (shading/tiles.py).
TILE = 0.25


@dataclass(frozen=True)
class Exemplar:
    normal: np.ndarray  #: (h, w, 4): normal values of the three axes, and of opacity
    table: np.ndarray  #: (ENTRIES, 4): what value each of them stands for
    axes: np.ndarray  #: (3, 3): row k is axis k, scene-linear RGB
    mean: np.ndarray  #: (3,)
    opaque: bool  #: whether opacity is 1 everywhere
    repeats: bool  #: whether opposite sides fit together, so that tiles may go over them


def exemplar(pixels: np.ndarray) -> Exemplar:
    """Of pixels (h, w, 4), scene-linear RGB and opacity, all finite."""
    pixels = np.asarray(pixels, np.float64)
    colours = pixels[..., :3].reshape(-1, 3)
    mean = colours.mean(axis=0)
    _, directions = np.linalg.eigh(np.atleast_2d(np.cov(colours.T, bias=True)))
    axes = directions.T[::-1]
    # With most of an axis positive, whatever the library's choice of sign.
    axes = axes * np.where(axes.sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    values = np.concatenate([(colours - mean) @ axes.T, pixels[..., 3].reshape(-1, 1)], axis=1)
    planes = values.reshape(*pixels.shape[:2], 4)
    repeats = _repeats(planes)
    weights = np.ones(pixels.shape[:2]) if repeats else usage(*pixels.shape[:2])
    made = [_as_normal(planes[..., k], weights) for k in range(4)]
    return Exemplar(
        normal=np.stack([normal for normal, _ in made], axis=-1).astype(np.float32),
        table=np.stack([table for _, table in made], axis=-1).astype(np.float32),
        axes=axes,
        mean=mean,
        opaque=bool((pixels[..., 3] >= 1.0 - 1e-6).all()),
        repeats=repeats,
    )


def for_interpolation(normal: np.ndarray) -> np.ndarray:
    """Normal values (h, w, 4) that have their deviation where a renderer looks between pixels, too: linear
    interpolation takes from it what neighbours differ by."""
    deviations = normal - MIDDLE
    variance = (deviations**2).mean(axis=(0, 1))
    kept = np.ones(normal.shape[2])
    for axis in (0, 1):
        # Between values a and b, at any place: a third of (a² + ab + b²).
        product = (deviations * np.roll(deviations, 1, axis)).mean(axis=(0, 1))
        kept *= 2.0 / 3.0 + np.divide(
            product, 3.0 * variance, out=np.full_like(variance, 1.0 / 3.0), where=variance > 0
        )
    return np.clip(MIDDLE + deviations / np.sqrt(kept), 0.0, 1.0).astype(np.float32)


def linear_from_srgb(colours: np.ndarray) -> np.ndarray:
    colours = np.clip(colours, 0.0, 1.0)
    return np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)


def reduced(pixels: np.ndarray, largest: int = LARGEST) -> np.ndarray:
    """Means of blocks of pixels, so that neither side is longer than `largest`."""
    factor = -(-max(pixels.shape[:2]) // largest)
    if factor == 1:
        return pixels
    rows, columns = (np.arange(0, size, factor) for size in pixels.shape[:2])
    sums = np.add.reduceat(np.add.reduceat(pixels, rows, axis=0), columns, axis=1)
    heights, widths = np.diff(rows, append=pixels.shape[0]), np.diff(columns, append=pixels.shape[1])
    return sums / (heights[:, None] * widths)[..., None]


def usage(height: int, width: int, tile: float = TILE) -> np.ndarray:
    """How often tiles that stay inside the image show each pixel; of mean 1."""
    shorter = min(height, width)
    shares = [_usage_along(size, tile * shorter / size) for size in (height, width)]
    return shares[0][:, None] * shares[1]


def _usage_along(size: int, radius: float) -> np.ndarray:
    """Of each pixel of a side: centers of tiles are spread evenly over what is at least a radius from its ends, and
    pixels are shown by their distance from the center."""
    middles = (np.arange(size) + 0.5) / size
    # A deviation of 0.23 radii, as tetrahedra and the default sharpness have it.
    spread = NormalDist(0.0, 0.23 * radius)
    shown = np.array([spread.cdf(x - radius) - spread.cdf(x - 1.0 + radius) for x in middles])
    shown = np.maximum(shown, 1e-3 * shown.max())
    return shown / shown.mean()


def _repeats(planes: np.ndarray) -> bool:
    """Whether opposite sides differ no more than neighbouring rows and columns do."""
    first = planes[..., 0]

    def fits(rows: np.ndarray) -> bool:
        inside = np.abs(np.diff(rows, axis=0)).mean() if len(rows) > 1 else 0.0
        return bool(np.abs(rows[0] - rows[-1]).mean() <= 1.5 * inside)

    return fits(first) and fits(first.T)


def _as_normal(plane: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of one axis (h, w) as normal ones, and the table back."""
    spread = np.ptp(plane)
    if spread <= 1e-9 * max(1.0, float(np.abs(plane).max())):
        return np.full(plane.shape, MIDDLE), np.full(ENTRIES, plane.mean())
    # Rounded: pixels that are equal but for arithmetic are equal, and in order by their surroundings.
    steps = np.round((plane - plane.min()) / spread * 1e6)
    around = sum(_blurred(plane, radius) for radius in (1, 3, 8))
    within = 0.9 * (around - around.min()) / max(np.ptp(around), 1e-300)
    order = np.argsort((steps + within).ravel(), kind="stable")
    counted = weights.ravel()[order]
    below = (np.cumsum(counted) - 0.5 * counted) / counted.sum()
    normal = np.empty(plane.size)
    normal[order] = _quantile(below)
    return normal.reshape(plane.shape), _table(np.sort(plane.ravel()))


def _quantile(below: np.ndarray) -> np.ndarray:
    """Of the normal distribution, as it is stored."""
    fine = np.linspace(-4.0, 4.0, 4001)
    z = np.interp(below, [NormalDist().cdf(value) for value in fine], fine)
    return np.clip(MIDDLE + DEVIATION * z, 0.0, 1.0)


def _table(ordered: np.ndarray) -> np.ndarray:
    z = (np.linspace(0.0, 1.0, ENTRIES) - MIDDLE) / DEVIATION
    place = np.array([NormalDist().cdf(value) for value in z]) * len(ordered) - 0.5
    return np.interp(place, np.arange(len(ordered)), ordered)


def _blurred(plane: np.ndarray, radius: int) -> np.ndarray:
    """Means over squares, beyond the border as at it."""
    for _ in range(2):  # along the rows, and turned, along the columns
        padded = np.pad(plane, [(radius + 1, radius), (0, 0)], mode="edge")
        total = np.cumsum(padded, axis=0)
        width = 2 * radius + 1
        plane = ((total[width:] - total[:-width]) / width).T
    return plane
