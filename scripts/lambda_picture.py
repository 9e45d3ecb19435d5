# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/pictures/lambda.png: keys map frames to λ, and the field is known for every λ.

.venv/bin/python scripts/lambda_picture.py
"""

from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot

TARGET = Path(__file__).parents[1] / "docs" / "pictures" / "lambda.png"
#: λ at which the storms meet, and the frames at which that happens with two ways to key λ.
MEETING, FRAMES = 0.6, {"straight": 60.0, "bent": 30.0}


def main() -> None:
    figure, (design, keys) = pyplot.subplots(1, 2, figsize=(9, 3.2), sharey=True, width_ratios=(1, 1.4))
    before, after = np.linspace(0.0, MEETING), np.linspace(MEETING, 1.0)
    distance = 0.5 * np.sqrt(1.0 - before / MEETING)
    for side in (-1.0, 1.0):
        design.plot(side * distance, before, color="tab:orange")
    design.plot(0.0 * after, after, color="tab:orange")
    design.set(title="design: two storms meet", xlabel="place on the surface", ylabel="λ", xticks=[], ylim=(0, 1))
    frames = np.linspace(0.0, 100.0, 200)
    curves = {
        "straight": frames / 100.0,
        "bent": (frames / 100.0) ** (np.log(MEETING) / np.log(FRAMES["bent"] / 100.0)),
    }
    for (name, lam), colour in zip(curves.items(), ("tab:blue", "tab:green"), strict=True):
        keys.plot(frames, lam, color=colour, label=f"{name} F-curve")
        keys.plot([FRAMES[name]] * 2, [0.0, MEETING], color=colour, linestyle=":")
    keys.set(title="keys: frames show λ", xlabel="frame", xlim=(0, 100))
    keys.legend(loc="lower right", frameon=False)
    for axis in (design, keys):
        axis.axhline(MEETING, color="gray", linewidth=0.8, linestyle="--")
    figure.tight_layout()
    figure.savefig(TARGET, dpi=90)


if __name__ == "__main__":
    main()
