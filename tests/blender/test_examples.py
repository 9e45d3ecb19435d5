# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example runs in a process of its own, small, and its pictures show something that moves."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from data_sets import data_set

bpy = pytest.importorskip("bpy")
pytest.importorskip("stormfield_native")

EXAMPLES = Path(__file__).resolve().parents[2] / "blend_examples"
SMALL = ("--frames", "3", "--percentage", "16", "--samples", "2", "--detail", "-2", "--no-film")


def run(script: str, *options: str) -> str:
    command = [sys.executable, str(EXAMPLES / script), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def pixels(path: Path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    shape = (image.size[1], image.size[0], image.channels)
    bpy.data.images.remove(image)
    return values.reshape(shape)[:, :, :3]


@pytest.mark.parametrize("name", ["storm_merge", "storm_on_suzanne", "split", "two_fields", "hurricane"])
def test_an_example_renders_a_texture_that_moves(name, tmp_path):
    if name == "hurricane":
        data_set("gfs_wind_michael_2018.npz")
    said = run(f"build_{name}.py", "--out", str(tmp_path), *SMALL)
    assert (tmp_path / f"{name}.blend").is_file()
    first, last = (pixels(tmp_path / "frames" / f"{name}_{frame:04d}.png") for frame in (1, 3))
    assert first.std() > 0.05, "the picture is empty"
    assert np.abs(last - first).mean() > 1e-3, "nothing moves"
    assert "frames:" in said


def test_the_field_flickers_less_than_one_interpolated_between_key_frames(tmp_path):
    said = run("build_storm_merge.py", "--out", str(tmp_path), *SMALL, "--render", "none")
    solved, linear = (float(percent) for percent in re.findall(r"flicker, .*: ([\d.]+) % per step", said))
    assert solved < linear


def test_a_rendered_scene_needs_no_addon(tmp_path):
    """The saved .blend renders the same picture in a Blender that has never heard of Stormfield."""
    run("build_storm_merge.py", "--out", str(tmp_path), *SMALL)
    code = (
        "import bpy, sys; bpy.ops.wm.open_mainfile(filepath=sys.argv[1]); bpy.context.scene.frame_set(3);"
        "bpy.context.scene.render.filepath = sys.argv[2]; bpy.ops.render.render(write_still=True);"
        "assert not hasattr(bpy.types.Object, 'stormfield')"
    )
    again = tmp_path / "again.png"
    subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "storm_merge.blend"), str(again)], check=True, timeout=300
    )
    difference = np.abs(pixels(again) - pixels(tmp_path / "frames" / "storm_merge_0003.png"))
    assert difference.mean() < 2e-3
