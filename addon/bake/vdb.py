"""VDB bands: the fields as vec3 grids on the voxels around the surface, for smoke, particles and other programs.

One frames/frame_0001.vdb per frame, numbered so that Blender's Volume object finds the sequence. Grids sf_orientation,
sf_advection (mesh units per second, object space), sf_speed and sf_distance; see native/io/vdb_band.h.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .. import native
from ..model.mesh_data import MeshData
from .manifest import MeshIdentity, Plan
from .store import CacheStore


@dataclass(frozen=True)
class VdbSettings:
    voxel_size: float = 0.0  #: mesh units; 0: the mean edge length
    half_width: float = 3.0  #: voxels on each side of the surface


class BandWriter:
    """Makes one volume per frame: prepare() and prepared() once, then draw() each."""

    def __init__(self, folder: Path, mesh: MeshData, frames, settings: VdbSettings, baked_from, *, resume: bool):
        self._settings = settings
        self._identity = MeshIdentity.of(mesh)
        content = {"vdb": asdict(settings), "from": baked_from}
        plan = Plan("vdb", "frame", tuple(int(frame) for frame in frames), self._identity, content)
        self.store = CacheStore(folder, plan, resume=resume, replace=True)
        self._band: Any = None

    def prepare(self, native_mesh):
        """Begins, on other threads, to find the voxels and the surface point each shows, once for all frames: a job for
        prepared()."""
        return native.start_vdb_band(native_mesh, self._settings.voxel_size, self._settings.half_width)

    def prepared(self, job) -> list[str]:
        """Waits for the job of prepare(); returns remarks for the artist."""
        self._band = job.result()
        return []

    def draw(self, fields: Mapping[str, Any], lam: float):
        """Begins a volume on other threads: a job whose result is the file's bytes, for store.write_bytes().

        fields: native.VectorField at λ by attribute name, on the mesh given to prepare().
        """
        return self._band.start_vdb(dict(fields), "sf_advection", self.metadata(lam))

    def finish(self) -> bool:
        return self.store.finish({})

    def metadata(self, lam: float) -> dict[str, str]:
        return {
            "stormfield:lambda": repr(float(lam)),
            "stormfield:mesh": self._identity.fingerprint,
            "stormfield:space": "object space, mesh units; vectors in mesh units per second",
            "stormfield:voxel_size": repr(self._band.voxel_size),
        }
