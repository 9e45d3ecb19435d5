# SPDX-License-Identifier: GPL-3.0-or-later
"""`make demo`: the storm merge as PNG frames and a film in out/demo."""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import build_storm_merge
import example


def main() -> None:
    began = time.perf_counter()
    out = example.REPOSITORY / "out" / "demo"
    # 854 × 480 pixels with two samples: a frame in less than two seconds on two cores.
    sys.argv[1:] = ["--out", str(out), "--percentage", "89", "--samples", "2", *sys.argv[1:]]
    build_storm_merge.main()
    minutes, seconds = divmod(round(time.perf_counter() - began), 60)
    print(f"The storm merge is rendered ({minutes} min {seconds} s):")
    print(f"  film    {out / 'storm_merge.mp4'}")
    print(f"  frames  {out / 'frames'}")
    print(f"  scene   {out / 'storm_merge.blend'}")


if __name__ == "__main__":
    example.run(main)
