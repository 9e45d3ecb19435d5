# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender shows on a mesh at a frame, with and without the add-on, as numbers."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np

WITHOUT_ADDON = """
import sys
import bpy, numpy as np
blend, name, out, *frames = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=blend)
assert not hasattr(bpy.types.Object, "stormfield")
rows = []
for frame in map(float, frames):
    bpy.context.scene.frame_set(int(frame // 1), subframe=frame % 1)
    mesh = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found = mesh.attributes.get("sf_advection")
    values = np.zeros(len(mesh.vertices) * 3, np.float32)
    if found is not None:
        found.data.foreach_get("vector", values)
    rows.append(values)
np.save(out, np.array(rows))
sys.stdout.flush()
import os
os._exit(0)
"""


def seen(obj, frame: float | None = None, name: str = "sf_advection") -> np.ndarray:
    """(n, 3) float32 of the evaluated mesh; zeros where it lacks the attribute."""
    if frame is not None:
        bpy.context.scene.frame_set(int(frame // 1), subframe=frame % 1)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found = mesh.attributes.get(name)
    values = np.zeros(len(mesh.vertices) * 3, np.float32)
    if found is not None:
        found.data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def seen_without_addon(blend: Path, name: str, frames, folder: Path) -> np.ndarray:
    """(frames, n, 3): what a Blender that does not know Stormfield shows."""
    script, out = folder / "without.py", folder / "without.npy"
    script.write_text(WITHOUT_ADDON)
    words = [sys.executable, str(script), str(blend), name, str(out), *map(str, frames)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = np.load(out)
    return rows.reshape(len(rows), -1, 3)


def off(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference over the largest speed of `b`."""
    return float(np.abs(a - b).max() / np.linalg.norm(b, axis=-1).max())


def key_lambda(obj, *keys) -> None:
    """Linear keys of λ instead of earlier ones: (frame, λ)."""
    obj.animation_data_clear()
    for frame, lam in keys:
        obj.stormfield.lam = lam
        obj.keyframe_insert("stormfield.lam", frame=frame)
    from stormfield import compat

    for key in compat.find_fcurve(obj, "stormfield.lam").keyframe_points:
        key.interpolation = "LINEAR"


def moving(storms) -> None:
    """Let the storms fade in and out over λ, so that every λ has a field of its own."""
    first, second = storms.stormfield.elements
    first.lam_end, second.lam_start = 0.6, 0.4
    second.kind = "vortex_cw"
