# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake as plain data, read once from the scene: what is written, for which frames, with which settings."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ..cache.fields import ADVECTION
from ..model.design import FieldName
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..model.words import FlowMapBasis, MorseMethod, MorseOptions

#: What a bake can write, by the words of the command line.
TargetName = Literal["usd", "exr", "vdb", "morse"]


@dataclass(frozen=True)
class FlowSettings:
    """The flowing texture's coordinates (targets/frames.py)."""

    period: int = 48  #: frames after which a phase starts anew
    speed: float = 1.0  #: factor on the advection field


@dataclass(frozen=True)
class ExrSettings:
    """Flow maps (targets/exr.py)."""

    uv_layer: str = ""  #: empty: the only or first layer
    resolution: int = 1024  #: width and height, pixels
    field: FieldName = "advection"
    basis: FlowMapBasis = "uv"  #: "uv": velocity of the UV coordinates and speed; "object": the vector itself
    half: bool = False  #: 16 instead of 32 bit floats
    margin: int = 8  #: pixels around each island


@dataclass(frozen=True)
class VdbSettings:
    """Volumes (targets/vdb.py)."""

    voxel_size: float = 0.0  #: mesh units; 0: the mean edge length
    half_width: float = 3.0  #: voxels on each side of the surface


@dataclass(frozen=True)
class MorseSettings:
    """How the Morse sets over λ are found (targets/morse.py): native.start_morse explains the options."""

    attribute: str = ADVECTION
    method: MorseMethod = "geometry"
    tau: float | None = None  #: seconds, or mesh units for "spatial"; None: found from mesh and field
    eps: float = 0.0  #: mean speeds

    def options(self) -> MorseOptions:
        """Of native.start_morse."""
        return {"method": self.method, "tau": self.tau, "eps": self.eps, "relative": True}


@dataclass(frozen=True)
class BakeTask:
    """A bake over frames. `frames` are all its frames, with λ at each; `only`, those that this machine writes (None:
    all). Folders of the targets lie in root."""

    cache: Path  #: the λ cache
    mesh: MeshData  #: with the UV layers
    frames: tuple[int, ...]
    lambdas: tuple[float, ...]
    root: Path
    frames_per_second: float = 24.0
    targets: frozenset[TargetName] = frozenset({"usd"})
    only: frozenset[int] | None = None
    polygons: Polygons | None = None
    flow: FlowSettings = field(default_factory=FlowSettings)
    exr: ExrSettings = field(default_factory=ExrSettings)
    vdb: VdbSettings = field(default_factory=VdbSettings)
    morse: MorseSettings = field(default_factory=MorseSettings)
    resume: bool = True
    verify: bool = False  #: read every file before the manifest vouches for it

    def indices(self) -> set[int]:
        """Places in `frames` of those that this machine writes. Raises InputError where they are none of the bake."""
        if len(self.frames) != len(self.lambdas) or not self.frames:
            raise InputError("a bake needs at least one frame, and λ at each")
        if self.only is None:
            return set(range(len(self.frames)))
        outside = sorted(self.only - set(self.frames))
        if outside:
            raise InputError(
                f"frame {outside[0]} is outside the bake, {self.frames[0]} to {self.frames[-1]}; "
                "set the scene's frame range to the whole animation"
            )
        return {index for index, frame in enumerate(self.frames) if frame in self.only}


@dataclass(frozen=True)
class BakeResult:
    """Folders of what was written by target; `absent` names what other machines have not finished yet, as
    TARGET/frames/NAME; `cache` is the λ cache it was made from, which may be another one than the task's."""

    folders: dict[TargetName, Path]
    remarks: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    cache: Path | None = None

    @property
    def whole(self) -> bool:
        """Whether every target is finished."""
        return not self.absent
