# SPDX-License-Identifier: GPL-3.0-or-later
"""VDB bands: the fields as vec3 grids on the voxels around the surface, for smoke, particles and other programs.

One frames/frame_0001.vdb per frame. Grids sf_orientation, sf_advection (mesh units per second, object space), sf_speed
and sf_distance: signed, negative inside, where the surface is closed. Only the voxels of the band are active
(native/io/voxel_band.h). Equal input gives equal bytes in one version of Blender.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Generator
from dataclasses import asdict
from functools import partial
from pathlib import Path

import numpy as np

from ... import native
from ...cache import fields
from ...cache.bundled import bundled
from ...model.words import Json
from ...work import Steps
from ..task import BakeTask
from .frame_files import FrameFiles
from .writing import disk_faults

#: Blocks of 8³ voxels that are filled between two steps.
BLOCKS = 256
#: Where the grids are filled and the file begins, in the fractions of its steps.
FILLED = 0.6
#: Where OpenVDB puts a random identifier: after magic number (8 bytes), file version (4), library version (8) and the
#: flag of the grid table (1).
IDENTIFIER = slice(21, 57)

#: Fills blocks first..last of a grid.
Fill = Callable[[int, int], np.ndarray]
#: By grid name.
Fields = dict[str, "native.VectorField"]


class Bands(FrameFiles["native.VoxelBand", Fields]):
    name = "vdb"
    preparing = "Finding the voxels around the surface"
    making = "Writing the volume"

    @staticmethod
    def check(task: BakeTask) -> None:
        """Any mesh has voxels around it. Raises InputError where no OpenVDB is."""
        bundled("openvdb")

    @classmethod
    def _settings(cls, task: BakeTask) -> dict[str, Json]:
        return asdict(task.vdb)

    def _start_shared(self, mesh: native.TriangleMesh) -> native.VoxelBandJob:
        return native.start_voxel_band(mesh, self._task.vdb.voxel_size, self._task.vdb.half_width)

    def _make(
        self, shared: native.VoxelBand, sample: dict[str, np.ndarray], mesh: native.TriangleMesh, message: str
    ) -> Steps[Fields]:
        return {name: fields.field_at(sample, name, mesh) for name in fields.ATTRIBUTE.values()}
        yield  # a generator: nothing here takes long

    def _write(self, shared: native.VoxelBand, content: Fields, lam: float, path: Path) -> Generator[float]:
        yield from write_volume(path, shared, content, self.metadata(shared, lam))

    def metadata(self, band: native.VoxelBand, lam: float) -> dict[str, str]:
        """Of the file at λ."""
        return {
            "stormfield:lambda": repr(float(lam)),
            "stormfield:mesh": self._identity.fingerprint,
            "stormfield:space": "object space, mesh units; vectors in mesh units per second",
            "stormfield:voxel_size": repr(band.voxel_size),
        }


def write_volume(path: Path, band: native.VoxelBand, fields_: Fields, metadata: dict[str, str]) -> Generator[float]:
    """Writes a VDB file in steps."""
    grids: list[object] = []
    parts = [*_vector_parts(band, fields_), ("sf_distance", "FloatGrid", band.distances)]
    for number, (name, kind, fill) in enumerate(parts):
        for fraction in _fill(grids, band, name, kind, fill):
            yield FILLED * (number + fraction) / len(parts)
    with disk_faults(path):
        bundled("openvdb").write(str(path), grids, metadata=metadata)
    yield 0.9
    _replace_identifier(path)
    yield 1.0


def _vector_parts(band: native.VoxelBand, fields_: Fields) -> list[tuple[str, str, Fill]]:
    parts: list[tuple[str, str, Fill]] = []
    for name, field in fields_.items():
        parts.append((name, "Vec3SGrid", partial(band.vectors, field)))
        if name == fields.ADVECTION:
            parts.append(("sf_speed", "FloatGrid", partial(band.speeds, field)))
    return parts


def _fill(grids: list[object], band: native.VoxelBand, name: str, kind: str, fill: Fill) -> Generator[float]:
    """Adds one grid, block by block. Values equal to the background stay inactive: what the core gives outside of the
    band is the background while the grid is filled."""
    openvdb = bundled("openvdb")
    outside = native.OUTSIDE_BAND
    grid = getattr(openvdb, kind)(background=outside if kind == "FloatGrid" else (outside,) * 3)
    grid.name = name
    grid.transform = openvdb.createLinearTransform(voxelSize=band.voxel_size)
    origins = band.origins.tolist()
    for first in range(0, len(origins), BLOCKS):
        last = min(first + BLOCKS, len(origins))
        for origin, block in zip(origins[first:last], fill(first, last), strict=True):
            grid.copyFromArray(block, ijk=origin)
        yield last / len(origins)
    if kind == "Vec3SGrid":
        grid.background = (0.0, 0.0, 0.0)
        grid.vectorType = "contravariant relative"
    elif name == "sf_distance":
        grid.background = band.voxel_size * band.half_width
        if band.closed:
            grid.signedFloodFill()
            grid.gridClass = "level set"
    else:
        grid.background = 0.0
    grids.append(grid)


def _replace_identifier(path: Path) -> None:
    """Puts a hash of the content in place of the random identifier: equal content gives equal files."""
    data = bytearray(path.read_bytes())
    data[IDENTIFIER] = b"0" * 36
    digits = hashlib.sha256(data).hexdigest()
    name = f"{digits[:8]}-{digits[8:12]}-4{digits[12:15]}-8{digits[15:18]}-{digits[18:30]}"
    with path.open("r+b") as file:
        file.seek(IDENTIFIER.start)
        file.write(name.encode())
