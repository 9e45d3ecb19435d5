"""Texture coordinates that flow, per frame (decision 12): what the materials read as sf_phase_a, sf_phase_b, sf_blend.

Each phase is the place, in object space, where the material at a vertex was when its cycle began, carried along the
advection field with λ as keyframed; the core explains the cycles (native/texture/advected_coordinates.h). Shaders blend
a solid texture T with mean m, taken at both phases, without losing contrast:

    m + ((1 - blend) (T(a) - m) + blend (T(b) - m)) / sqrt((1 - blend)² + blend²)

Each frame is computed from the task alone, not from its neighbours: any part of a bake gives the same bytes. Before its
first frame the animation is taken to stand still at the first λ.
"""

import numpy as np

from .. import native

PHASE_A, PHASE_B, BLEND = "sf_phase_a", "sf_phase_b", "sf_blend"


class FlowFrames:
    """The frames of a task (job.BakeTask: frames, lambdas, frames_per_second, flow) on its advection field."""

    def __init__(self, field, task):
        self.frames = tuple(task.frames)
        self.coordinates = native.AdvectedCoordinates(
            field,
            np.asarray(task.frames, np.float64),
            np.asarray(task.lambdas, np.float64),
            frames_per_second=float(task.frames_per_second),
            period=float(task.flow.period),
            speed=float(task.flow.speed),
        )

    def start(self, index: int):
        """Begins the task's frame of that index on other threads: a job with .done, .fraction, .cancel()."""
        return self.coordinates.start([self.frames[index]])

    def finish(self, job) -> dict[str, np.ndarray]:
        """Waits for a started frame: its attributes, float32, (n, 3) and (n,)."""
        ((phase_a, phase_b, blend),) = job.result()
        return {PHASE_A: phase_a, PHASE_B: phase_b, BLEND: blend}

    def attributes(self, index: int) -> dict[str, np.ndarray]:
        """Both in one blocking call."""
        return self.finish(self.start(index))

    def error(self, index: int) -> dict[str, float]:
        """Error of the carried coordinates against much finer traces, in mean edge lengths."""
        return self.coordinates.error(self.frames[index])
