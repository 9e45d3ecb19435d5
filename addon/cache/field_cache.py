# SPDX-License-Identifier: GPL-3.0-or-later
"""The field caches: vertex attributes over λ, or over frames, on the artist's own mesh
(docs/architecture.md, decisions 6 and 7).

    writer = FieldCacheWriter(folder, mesh, lambdas, settings, resume=True)
    for j in writer.missing():
        writer.write_sample(j, {"sf_advection": (n, 3) float32, "sf_speed": (n,) float32, ...})
    run(writer.finish())                              # False while samples of other machines are missing

    cache = open_cache(folder)                        # InputError: no cache, unfinished, newer schema
    cache.lambdas, cache.mesh, cache.sample(3)["sf_speed"], cache.at(0.5)["sf_speed"]

What is read is bit for bit what was written, and equal input gives equal files. The layout is in usd.py; what a folder
promises, in store.py.
"""

import itertools
import os
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..model.words import Json
from ..work import Steps, with_message
from . import usd
from .checksums import known_sha256
from .layout import MANIFEST, OLD_MESH, OLD_STAGE, STAGE
from .manifest import Manifest, read_manifest
from .plan import MeshIdentity, Plan
from .store import CacheStore, Joint

Attributes = Mapping[str, np.ndarray]


class _Writer:
    """What both caches share: the samples' shape is checked, files go through the store."""

    def __init__(
        self,
        folder: str | os.PathLike,
        mesh: MeshData,
        axis: str,
        times: Sequence[float],
        settings: Mapping[str, Json],
        *,
        polygons: Polygons | None,
        resume: bool,
        replace: bool,
    ):
        if len(times) == 0:
            raise InputError(f"a cache over {axis} needs at least one sample")
        if any(not a < b for a, b in itertools.pairwise(times)):
            raise InputError(f"the samples of a cache over {axis} must increase")
        self._mesh = mesh
        self._polygons = polygons
        self._plan = Plan("usd", axis, tuple(times), MeshIdentity.of(mesh), settings)
        self._time_codes = self._plan.time_codes
        joint = Joint(STAGE, self._join_samples, self._extract)
        self._store = CacheStore(folder, self._plan, resume=resume, replace=replace, joint=joint)

    @property
    def folder(self) -> Path:
        return self._store.folder

    def missing(self, among: Iterable[int] | None = None) -> list[int]:
        """Samples (of those `among`) still to write, in order."""
        return self._store.missing(among)

    def write_sample(self, index: int, attributes: Attributes) -> None:
        """Arrays per attribute: (n, 3) or (n,), a row per vertex, finite, stored as float32; or integers (f,), one per
        polygon."""
        checked = self._checked(index, attributes)
        self._store.write(index, lambda path: usd.write_sample(path, self._time_codes[index], checked))

    def absent(self) -> list[str]:
        """Names of the samples that no machine has finished."""
        return self._store.absent()

    def finish(self, *, verify: bool = False) -> Steps[bool]:
        """Joins the samples, then writes the manifest. False while samples are missing. verify: reads them all."""
        return with_message(self._store.finish(verify=verify), "Joining the samples")

    def write_all(self, samples: Iterable[Attributes | None]) -> Steps[None]:
        """Writes all samples at once, in order, and finishes the cache: the same files as one by one, sooner. None for
        a sample that is not there yet. Nothing is kept where the steps are closed before their end."""
        checked = self._all_checked(samples)
        return with_message(self._store.write_all(partial(self._write_stage, checked)), "Writing the samples")

    def _all_checked(self, samples: Iterable[Attributes | None]) -> Iterator[Attributes | None]:
        index = 0
        for attributes in samples:
            yield None if attributes is None else self._checked(index, attributes)
            index += attributes is not None

    def _checked(self, index: int, attributes: Attributes) -> Attributes:
        for name, values in attributes.items():
            self._check(index, name, values)
        return attributes

    def _join_samples(self, path: Path) -> Generator[float]:
        return self._write_stage((usd.read_sample(self.folder / name) for name in self._plan.names), path)

    def _write_stage(self, samples: Iterable[Attributes | None], path: Path) -> Generator[float]:
        return usd.write_stage(path, self._mesh, self._polygons, self._time_codes, samples)

    def _extract(self, index: int, path: Path) -> None:
        time_code = self._time_codes[index]
        usd.write_sample(path, time_code, usd.read_sample(self.folder / STAGE, time_code))

    def _check(self, index: int, name: str, values: np.ndarray) -> None:
        count = len(self._mesh.vertices)
        if usd.per_polygon(values):
            faces = len(self._mesh.triangles if self._polygons is None else self._polygons.counts)
            if values.shape != (faces,):
                raise InputError(f"{name} of sample {index} has shape {values.shape}; the mesh has {faces} polygons")
            return
        if values.shape not in ((count,), (count, 3)):
            raise InputError(f"{name} of sample {index} has shape {values.shape}; the mesh has {count} vertices")
        if not np.isfinite(values).all():
            bad = np.flatnonzero(~np.isfinite(values.reshape(count, -1)).all(axis=1))
            raise InputError(f"{name} of sample {index} is not finite at vertex {bad[0]}")


class FieldCacheWriter(_Writer):
    """Writes a λ cache: lambdas strictly increasing in 0..1, samples/lam_0000.usdc and so on.

    settings: JSON of all that decides the samples (the design); a resumed bake must have the same.
    polygons: the artist's own faces (see usd.py); the triangles of the mesh when None.
    resume, replace: see CacheStore.
    """

    def __init__(
        self,
        folder: str | os.PathLike,
        mesh: MeshData,
        lambdas: Sequence[float],
        settings: Mapping[str, Json],
        *,
        polygons: Polygons | None = None,
        resume: bool = False,
        replace: bool = False,
    ):
        times = [float(lam) for lam in lambdas]
        if any(not 0.0 <= lam <= 1.0 for lam in times):
            raise InputError("the samples of a λ cache must lie in 0..1")
        super().__init__(folder, mesh, "lambda", times, settings, polygons=polygons, resume=resume, replace=replace)


class FrameCacheWriter(_Writer):
    """Writes a frame cache: frames increasing integers, frames/frame_0001.usdc and so on. Arguments as above.

    `frames` are all frames of the bake; a machine that bakes only some of them writes those samples.
    """

    def __init__(
        self,
        folder: str | os.PathLike,
        mesh: MeshData,
        frames: Sequence[int],
        settings: Mapping[str, Json],
        *,
        polygons: Polygons | None = None,
        resume: bool = False,
        replace: bool = False,
    ):
        times = [int(frame) for frame in frames]
        super().__init__(folder, mesh, "frame", times, settings, polygons=polygons, resume=resume, replace=replace)


class FieldCache:
    """A finished cache, read lazily. Every file is checked against the manifest before it is read."""

    def __init__(self, folder: Path, manifest: Manifest):
        self.folder = folder
        self.manifest = manifest
        self._mesh: MeshData | None = None

    @property
    def settings(self) -> Mapping[str, Json]:
        return self.manifest.plan.settings

    @property
    def times(self) -> np.ndarray:
        """λ of every sample, or its frame."""
        return np.array(self.manifest.plan.times, np.float64)

    @property
    def lambdas(self) -> np.ndarray:
        if self.manifest.plan.axis != "lambda":
            raise InputError(f"{self.folder}: is a cache over frames, not over λ; name the λ cache")
        return self.times

    @property
    def frames(self) -> np.ndarray:
        if self.manifest.plan.axis != "frame":
            raise InputError(f"{self.folder}: is a cache over λ, not over frames; name the frame cache")
        return self.times.astype(np.int64)

    @property
    def mesh(self) -> MeshData:
        if self._mesh is None:
            self._mesh = self._read_mesh()
        return self._mesh

    def check_mesh(self, mesh: MeshData) -> None:
        """Raises InputError when the cache belongs to another mesh."""
        own = self.manifest.plan.mesh
        if MeshIdentity.of(mesh) != own:
            raise InputError(
                f"{self.folder}: is the cache of another mesh ({own.vertices} vertices, {own.faces} triangles); "
                f"this one has {len(mesh.vertices)} and {len(mesh.triangles)}, or another shape: solve it again"
            )

    def sample(self, index: int) -> dict[str, np.ndarray]:
        """Attributes of one sample, float32 per vertex, int32 per polygon."""
        plan = self.manifest.plan
        if plan.names[index] in self.manifest.files:  # single samples, in caches of schema 1
            return usd.read_sample(self._file(plan.names[index]))
        return usd.read_sample(self._file(STAGE), plan.time_codes[index])

    def at(self, time: float) -> dict[str, np.ndarray]:
        """Attributes at λ (or a frame), constant outside, between samples linear; integers as in the sample before."""
        times = self.times
        j = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1))
        if j == len(times) - 1 or time <= times[j]:
            return self.sample(j)
        weight = np.float32((time - times[j]) / (times[j + 1] - times[j]))
        before, after = self.sample(j), self.sample(j + 1)
        return {
            name: old if usd.per_polygon(old) else old + weight * (after[name] - old) for name, old in before.items()
        }

    def values(self, attribute: str) -> np.ndarray:
        """All samples of one attribute: (s, n, 3) or (s, n)."""
        if STAGE in self.manifest.files:
            return usd.read_values(self._file(STAGE), attribute, self.manifest.plan.time_codes)
        return np.stack([self.sample(j)[attribute] for j in range(len(self.manifest.plan.times))])

    def _read_mesh(self) -> MeshData:
        """Checked by its own fingerprint: the file that holds it also holds all samples, and may be large."""
        path = self.folder / (STAGE if STAGE in self.manifest.files else OLD_MESH)
        if not path.is_file():
            raise InputError(f"{path}: is missing; resume the bake to write it again")
        mesh = MeshData(*usd.read_mesh(path))
        if MeshIdentity.of(mesh) != self.manifest.plan.mesh:
            raise InputError(f"{path}: is damaged (its mesh is not that of the manifest); resume the bake")
        return mesh

    def _file(self, name: str) -> Path:
        path = self.folder / name
        if not path.is_file():
            raise InputError(f"{path}: is missing; resume the bake to write it again")
        if known_sha256(path) != self.manifest.files[name]:
            raise InputError(f"{path}: is damaged (its checksum differs from the manifest); resume the bake")
        return path


def open_cache(folder: str | os.PathLike) -> FieldCache:
    """The finished USD cache of a folder (or of its field.usdc)."""
    folder = Path(folder)
    if folder.name in (STAGE, OLD_STAGE):
        folder = folder.parent
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; solve or bake first")
    manifest = read_manifest(folder / MANIFEST)
    if manifest.plan.target != "usd":
        raise InputError(f"{folder}: holds {manifest.plan.target} files; name the folder of the λ or frame cache")
    return FieldCache(folder, manifest)
