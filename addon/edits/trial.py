# SPDX-License-Identifier: GPL-3.0-or-later
"""A move tried for one place after another, while the pointer drags the point: the newest place wins.

trial = MoveTrial(field, entity)
trial.aim(place); trial.poll()      # never waits; True when .result is another than before
trial.result                        # of the last place that was tried to its end
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.edits import EntityAt
from ..model.errors import InputError
from .single import find_entity


@dataclass(frozen=True, eq=False)
class Tried:
    """Where the point would stand, whether it can, the faces that would change, and why not."""

    place: np.ndarray
    allowed: bool
    faces: np.ndarray
    reason: str


class MoveTrial:
    def __init__(self, field: native.VectorField, entity: EntityAt) -> None:
        self.result: Tried | None = None
        self._field, self._entity = field, entity
        self._topology: native.Topology | None = None
        self._analysis: native.TopologyJob | None = native.start_topology(field)
        self._job: native.EditJob | None = None
        self._tried: np.ndarray | None = None  #: the place of the running job
        self._aim: np.ndarray | None = None

    def aim(self, place: np.ndarray) -> None:
        """Try this place next; what runs for another one is stopped."""
        self._aim = np.array(place, float)
        if self._job is not None:
            self._job.cancel()

    def poll(self) -> bool:
        """Take over what is done, begin what is asked for. Raises InputError where the point is not there."""
        if self._analysis is not None:
            if not self._analysis.done:
                return False
            self._topology, self._analysis = self._analysis.result(), None
        changed = self._collect()
        if self._job is None and self._aim is not None:
            self._begin()
        return changed

    def close(self) -> None:
        """Stop what runs."""
        for job in (self._analysis, self._job):
            if job is not None:
                job.cancel()
        self._analysis = self._job = None

    def _collect(self) -> bool:
        if self._job is None or not self._job.done:
            return False
        job, self._job = self._job, None
        try:
            found = job.result()
        except native.Cancelled:
            return False
        except (InputError, native.SolverError) as fault:
            self.result = Tried(self._place(), False, np.zeros(0, np.int32), str(fault))
            return True
        self.result = Tried(self._place(), found.applied, np.asarray(found.faces), found.reason)
        return True

    def _place(self) -> np.ndarray:
        return np.zeros(3) if self._tried is None else self._tried

    def _begin(self) -> None:
        if self._topology is None or self._aim is None:
            return
        self._tried, self._aim = self._aim, None
        faces, barycentric, _ = self._field.mesh.closest_points(self._tried[None])
        _, number = find_entity(self._field.mesh, self._topology, self._entity)
        place = np.array(barycentric[0])
        self._job = native.start_move_point(self._field, self._topology, number, int(faces[0]), place)
