# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the README, from frames that the examples have rendered: docs/pictures/*.jpg.

.venv/bin/python blend_examples/build_storm_merge.py       (and the other three)
.venv/bin/python scripts/readme_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

REPOSITORY = Path(__file__).resolve().parent.parent
PICTURES = REPOSITORY / "docs" / "pictures"
# Name of the picture: (example, its frames, columns, width of the picture)
SHEETS = {
    "storm_merge": ("storm_merge", (1,), 1, 960),
    "storm_merge_frames": ("storm_merge", (1, 34, 50, 80), 2, 1200),
    "storm_on_suzanne": ("storm_on_suzanne", (24,), 1, 960),
    "split": ("split", (8, 38, 68), 3, 1200),
    "two_fields": ("two_fields", (4, 30, 58), 3, 1200),
}
GAP = 6  # pixels between the frames of a sheet


def read(path: Path, width: int) -> np.ndarray:
    """The picture at that width: (height, width, 4), from the bottom up, as Blender keeps it."""
    image = bpy.data.images.load(str(path))
    image.scale(width, round(width * image.size[1] / image.size[0]))
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    shape = (image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return values.reshape(shape)


def sheet(paths: list[Path], columns: int, width: int) -> np.ndarray:
    each = (width - GAP * (columns - 1)) // columns
    frames = [read(path, each) for path in paths]
    height = frames[0].shape[0]
    rows = -(-len(frames) // columns)
    result = np.ones((rows * (height + GAP) - GAP, columns * (each + GAP) - GAP, 4), np.float32)
    for index, frame in enumerate(frames):
        row, column = divmod(index, columns)
        bottom, left = (rows - 1 - row) * (height + GAP), column * (each + GAP)
        result[bottom : bottom + height, left : left + each] = frame
    return result


def write(pixels: np.ndarray, path: Path) -> None:
    image = bpy.data.images.new(path.stem, pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.filepath_raw, image.file_format = str(path), "JPEG"
    image.save(quality=88)
    bpy.data.images.remove(image)


def main() -> None:
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name, (example, frames, columns, width) in SHEETS.items():
        paths = [REPOSITORY / "out" / example / "frames" / f"{example}_{frame:04d}.png" for frame in frames]
        missing = [path for path in paths if not path.is_file()]
        if missing:
            print(f"{name}: {missing[0].relative_to(REPOSITORY)} is missing; run blend_examples/build_{example}.py")
            continue
        write(sheet(paths, columns, width), PICTURES / f"{name}.jpg")
        print(f"{name}: {(PICTURES / f'{name}.jpg').relative_to(REPOSITORY)}")


if __name__ == "__main__":
    main()
