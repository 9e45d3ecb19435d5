# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the element presets, addon/ui/preset_pictures/NAME.png: the flow around each as a line integral
convolution (Cabral and Leedom 1993). Needs NumPy alone.

    .venv/bin/python scripts/preset_pictures.py
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parents[1] / "addon" / "ui" / "preset_pictures"
SIZE, FINE = 96, 2
#: Steps of a streamline each way, in fine pixels, and the seed of the noise.
STEPS, SEED = 22, 7

Flow = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def turning(turn: float, out: float) -> Flow:
    return lambda x, y: (out * x - turn * y, out * y + turn * x)


def stream(speed: float) -> Flow:
    """Along a bent line, fading away from it."""

    def flow(x, y):
        slope = 0.9 * np.cos(2.4 * x)
        return np.ones_like(x), slope * np.exp(-(speed * (y - 0.37 * np.sin(2.4 * x)) ** 2))

    return flow


def merging(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two vortices beside each other."""
    u, v = np.zeros_like(x), np.zeros_like(y)
    for place in (-0.42, 0.42):
        weight = 1.0 / ((x - place) ** 2 + y**2 + 0.06)
        u, v = u - weight * y, v + weight * (x - place)
    return u, v


#: File name → flow, colour (sRGB), and how far from the middle it fades.
PICTURES: dict[str, tuple[Flow, tuple[float, float, float], float]] = {
    "merge": (merging, (0.95, 0.80, 0.35), 0.9),
    "cyclone": (turning(1.0, -0.45), (0.35, 0.70, 0.95), 0.9),
    "anticyclone": (turning(-1.0, 0.45), (0.95, 0.62, 0.30), 0.9),
    "eye": (turning(1.0, 0.0), (0.93, 0.88, 0.45), 0.9),
    "spring": (turning(0.0, 1.0), (0.40, 0.80, 0.55), 0.9),
    "drain": (turning(0.0, -1.0), (0.90, 0.45, 0.45), 0.9),
    "saddle": (lambda x, y: (x, -y), (0.45, 0.55, 0.95), 0.9),
    "jet": (stream(2.0), (0.95, 0.75, 0.25), 0.35),
    "calm": (stream(0.3), (0.60, 0.72, 0.80), 0.8),
    "particle": (stream(1.0), (0.85, 0.55, 0.72), 0.22),
    "wind": (lambda x, y: (np.ones_like(x), 0.35 * np.ones_like(y)), (0.82, 0.85, 0.90), 0.9),
}


def paint(flow: Flow, colour: tuple[float, float, float], reach: float) -> np.ndarray:
    """(SIZE, SIZE, 4) in 0..1, the first row at the top."""
    count = SIZE * FINE
    axis = (np.arange(count) + 0.5) / count * 2.0 - 1.0
    x, y = np.meshgrid(axis, -axis)
    noise = np.random.default_rng(SEED).random((count, count))
    total, weight = noise.copy(), np.ones_like(noise)
    for sign in (1.0, -1.0):
        px, py = x.copy(), y.copy()
        for step in range(STEPS):
            u, v = flow(px, py)
            length = np.maximum(np.hypot(u, v), 1e-9)
            px, py = px + sign * u / length * 2.0 / count, py + sign * v / length * 2.0 / count
            column = np.clip(((px + 1.0) / 2.0 * count).astype(int), 0, count - 1)
            row = np.clip(((1.0 - py) / 2.0 * count).astype(int), 0, count - 1)
            # Brighter ahead: the streak has a front and a tail.
            share = 1.0 - step / STEPS if sign < 0 else 0.45 * (1.0 - step / STEPS)
            total += share * noise[row, column]
            weight += share
    grey = total / weight
    grey = np.clip((grey - grey.mean()) / (2.6 * grey.std()) + 0.5, 0.0, 1.0)
    distance = np.abs(y - 0.37 * np.sin(2.4 * x)) if reach < 0.85 else 0.0 * x
    inside = np.clip((0.97 - np.hypot(x, y)) * count / 8.0, 0.0, 1.0)
    strength = np.exp(-((distance / max(reach, 1e-9)) ** 2)) if reach < 0.85 else np.ones_like(x)
    rgb = (0.10 + 0.90 * grey[..., None] ** 1.3) * np.array(colour) * (0.25 + 0.75 * strength[..., None])
    rgba = np.concatenate([rgb, inside[..., None]], axis=2)
    return rgba.reshape(SIZE, FINE, SIZE, FINE, 4).mean(axis=(1, 3))


def write_png(path: Path, pixels: np.ndarray) -> None:
    rows = np.round(pixels * 255.0).astype(np.uint8)
    raw = b"".join(b"\0" + row.tobytes() for row in rows)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", rows.shape[1], rows.shape[0], 8, 6, 0, 0, 0)
    parts = (chunk(b"IHDR", head), chunk(b"IDAT", zlib.compress(raw, 9)), chunk(b"IEND", b""))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, (flow, colour, reach) in PICTURES.items():
        write_png(FOLDER / f"{name}.png", paint(flow, colour, reach))
        print((FOLDER / f"{name}.png").relative_to(FOLDER.parents[2]))


if __name__ == "__main__":
    main()
