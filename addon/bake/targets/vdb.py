# SPDX-License-Identifier: GPL-3.0-or-later
"""VDB bands: the fields as vec3 grids on the voxels around the surface, for smoke, particles and other programs.

One frames/frame_0001.vdb per frame. Grids sf_orientation, sf_advection (mesh units per second, object space), sf_speed
and sf_distance; see native/io/vdb_band.h.
"""

from dataclasses import asdict
from typing import Any

import numpy as np

from ... import native
from ...cache import fields
from ..task import BakeTask
from .frame_files import FrameFiles


class Bands(FrameFiles):
    name = "vdb"
    preparing = "Finding the voxels around the surface"
    making = "Writing the volume"

    @staticmethod
    def check(task: BakeTask) -> None:
        """Any mesh has voxels around it."""

    def _settings(self) -> dict[str, Any]:
        return asdict(self._task.vdb)

    def _start_shared(self, mesh: Any) -> Any:
        return native.start_vdb_band(mesh, self._task.vdb.voxel_size, self._task.vdb.half_width)

    def _start_file(self, shared: Any, sample: dict[str, np.ndarray], mesh: Any, lam: float) -> Any:
        bands = {name: fields.field_at(sample, name, mesh) for name in fields.ATTRIBUTE.values()}
        return shared.start_vdb(bands, fields.ADVECTION, self.metadata(shared, lam))

    def metadata(self, band: Any, lam: float) -> dict[str, str]:
        """Of the file at λ. band: native VdbBand."""
        return {
            "stormfield:lambda": repr(float(lam)),
            "stormfield:mesh": self._identity.fingerprint,
            "stormfield:space": "object space, mesh units; vectors in mesh units per second",
            "stormfield:voxel_size": repr(band.voxel_size),
        }
