# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings of the algorithms' pages: docs/pictures/algorithms/*.png.

.venv/bin/python scripts/algorithm_pictures.py
"""

import itertools
from pathlib import Path

import matplotlib
import numpy as np
import stormfield_native as native

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.collections import LineCollection

TARGET = Path(__file__).parents[1] / "docs" / "pictures" / "algorithms"
COLOURS = {"source": "tab:green", "sink": "tab:red", "saddle": "tab:blue", "center": "goldenrod"}


def merge() -> pyplot.Figure:
    """The joint field of two storms at three distances: (z - a)(z - b) conj(z - s), turned by a right angle."""
    figure, axes = pyplot.subplots(1, 3, figsize=(9, 3.2))
    axis = np.linspace(-1.0, 1.0, 200)
    z = axis[None, :] + 1j * axis[:, None]
    for panel, distance in zip(axes, (1.1, 0.6, 0.0), strict=True):
        a, b, s = -distance / 2, distance / 2, 0.0
        field = 1j * (z - a) * (z - b) * np.conj(z - s)
        panel.streamplot(axis, axis, field.real, field.imag, color="gray", linewidth=0.6, density=1.0, arrowsize=0.6)
        marks = [("center", a), ("center", b), ("saddle", s)] if distance else [("center", 0.0)]
        for kind, place in marks:
            panel.plot(place, 0.0, "o" if kind == "center" else "D", color=COLOURS[kind], markeredgecolor="white")
        panel.set(
            aspect="equal", xticks=[], yticks=[], title="apart" if distance > 1 else "near" if distance else "merged"
        )
    return figure


def phases() -> pyplot.Figure:
    """Ages of both phases over two periods, and the weight of the second, which hides every new start."""
    figure, (ages, weight) = pyplot.subplots(2, 1, figsize=(7, 3.2), sharex=True, height_ratios=(1.3, 1))
    frames = np.linspace(0.0, 96.0, 2000)
    age_a, age_b = (frames / 48.0) % 1.0, (frames / 48.0 + 0.5) % 1.0
    for age, name in ((age_a, "phase a"), (age_b, "phase b")):
        broken = np.where(np.abs(np.diff(age, append=age[-1])) > 0.5, np.nan, age)
        ages.plot(frames, broken, label=name)
    dead = 0.1
    # Near its start or end the age of a phase is within the dead zone, and its weight is 0.
    seen = np.clip((np.minimum(age_a, 1.0 - age_a) - dead) / (0.5 - 2 * dead), 0.0, 1.0)
    seen = seen * seen * (3.0 - 2.0 * seen)
    weight.plot(frames, seen, label="weight of a")
    weight.plot(frames, 1.0 - seen, label="weight of b")
    ages.set(ylabel="age (periods)")
    weight.set(ylabel="weight", xlabel="frame (period 48)")
    for panel in (ages, weight):
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
        panel.set_xlim(0, 96)
    return figure


def even_speed() -> pyplot.Figure:
    """Speed over the distance from a fixed point: as solved, and with amount 0.5 and 1."""
    figure, panel = pyplot.subplots(figsize=(6, 2.8))
    distance = np.linspace(0.0, 4.0, 400)
    solved = distance * np.exp(-distance)
    reach, limit = 0.15, 0.3
    gradient = np.gradient(solved, distance) ** 2 / 2 + (solved / np.maximum(distance, 1e-9)) ** 2 / 2
    factor = limit / np.sqrt(solved**2 + reach**2 * gradient + 1e-12)
    for amount in (0.0, 0.5, 1.0):
        panel.plot(distance, solved * factor**amount, label=f"amount {amount:g}")
    panel.set(xlabel="distance from the fixed point", ylabel="speed", ylim=(0, None))
    panel.legend(frameon=False)
    return figure


def streamlines() -> pyplot.Figure:
    """Evenly spaced lines of a field with a source, a saddle, a sink and a closed streamline."""
    count = 60
    axis = np.linspace(-1.0, 1.0, count + 1)
    x, y = (each.ravel() for each in np.meshgrid(axis, axis))
    corner = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).ravel()
    a, b, c, d = corner, corner + 1, corner + count + 2, corner + count + 1
    faces = np.stack([a, b, c, a, c, d], 1).reshape(-1, 3).astype(np.int32)
    mesh = native.TriangleMesh(np.stack([x, y, 0 * x], 1), faces)
    z = x + 1j * y
    value = (
        1j * (z + 0.5) * np.conj(z - 0.05) * (z - 0.55) * np.exp(0.9j * (x > 0.05) * np.clip((x - 0.05) / 0.3, 0, 1))
    )
    field = native.VectorField.from_space(mesh, np.stack([value.real, value.imag, 0 * x], 1))
    lines = native.start_evenly_spaced_streamlines(field, 0.05).result()
    places = mesh.positions(np.asarray(lines.faces), np.asarray(lines.barycentric))[:, :2]
    offsets = np.asarray(lines.offsets)
    figure, panel = pyplot.subplots(figsize=(4.2, 4.2))
    panel.add_collection(
        LineCollection([places[i:j] for i, j in itertools.pairwise(offsets)], colors="gray", linewidths=0.8)
    )
    for point in native.fixed_points(field):
        panel.plot(*point.position[:2], "o", color=COLOURS.get(str(point.kind), "black"), markeredgecolor="white")
    panel.set(aspect="equal", xticks=[], yticks=[], xlim=(-1, 1), ylim=(-1, 1))
    return figure


def main() -> None:
    TARGET.mkdir(parents=True, exist_ok=True)
    for draw in (merge, phases, even_speed, streamlines):
        figure = draw()
        figure.tight_layout()
        figure.savefig(TARGET / f"{draw.__name__}.png", dpi=90)


if __name__ == "__main__":
    main()
