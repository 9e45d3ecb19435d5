# SPDX-License-Identifier: GPL-3.0-or-later
"""An off-screen picture that the overlay is drawn into, and what is drawn: for the benchmarks of the overlay.

Needs a Blender with gpu.init (5.2) and an OpenGL or Vulkan driver. The regions of the factory file's 3D view are there
without a window too, so that draw handlers find all that they ask a context for.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace

import bpy
import gpu
import numpy as np
from mathutils import Vector


def has_gpu() -> bool:
    if not hasattr(gpu, "init"):
        print("this Blender draws only in a window: use Blender 5.2 or later")
        return False
    gpu.init()
    return True


def start() -> None:
    """The factory file with Stormfield and nothing in it."""
    import stormfield

    bpy.ops.wm.read_factory_settings()
    stormfield.register()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


class Seen:
    """A context as in a window of 100 %: without one the interface has no scale."""

    def __init__(self, context: bpy.types.Context) -> None:
        self._context = context
        self.preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0, use_region_overlap=True))

    def __getattr__(self, name: str):
        return getattr(self._context, name)


@contextmanager
def view(direction: Vector, distance: float) -> Iterator[Seen]:
    """The context of a 3D view that looks at the origin, and a picture as large as it, bound."""
    window = bpy.context.window_manager.windows[0]
    area = max((a for a in window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width * a.height)
    region = next(region for region in area.regions if region.type == "WINDOW")
    target = gpu.types.GPUOffScreen(region.width, region.height, format="RGBA8")
    with bpy.context.temp_override(window=window, area=area, region=region), target.bind():
        seen = bpy.context.region_data
        seen.view_rotation = direction.to_track_quat("Z", "Y")
        seen.view_distance, seen.view_location = distance, (0.0, 0.0, 0.0)
        seen.update()
        yield Seen(bpy.context)
        import stormfield

        stormfield.unregister()  # gives back what the GPU holds, while it is there
    target.free()


def clear(colour: tuple[float, float, float]) -> None:
    gpu.state.active_framebuffer_get().clear(color=(*colour, 1.0), depth=1.0)


def finish() -> None:
    """Wait for the GPU."""
    gpu.state.active_framebuffer_get().read_color(0, 0, 1, 1, 4, 0, "UBYTE")


def pixels(context: Seen) -> np.ndarray:
    """(height, width, 3) sRGB bytes of what was drawn, from the bottom."""
    width, height = context.region.width, context.region.height
    buffer = gpu.state.active_framebuffer_get().read_color(0, 0, width, height, 4, 0, "UBYTE")
    return np.array(buffer, dtype=np.uint8).reshape(height, width, 4)[..., :3]


def save(drawn: np.ndarray, path: str) -> None:
    image = bpy.data.images.new("drawn", drawn.shape[1], drawn.shape[0])
    rgba = np.concatenate([drawn / 255.0, np.ones((*drawn.shape[:2], 1))], axis=2)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
