# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a bake: everything known before its first sample is written.

    plan = Plan("usd", "lambda", (0.0, 0.5, 1.0), MeshIdentity.of(mesh), settings)
    plan.names                       # samples/lam_0000.usdc ...
    root / plan.folder_name("lambda")

Two bakes with equal plans write equal bytes, on any machine. Names are relative to the cache's folder, with forward
slashes, and follow NAME; nothing else is ever deleted.
"""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass

from ..model.mesh_data import MeshData
from ..model.words import Json
from .layout import TIME_CODES_PER_LAMBDA

SCHEMA = "stormfield.cache"
VERSION = 2

#: Formats of samples, and the endings of their files.
EXTENSIONS = {"usd": "usdc", "exr": "exr", "vdb": "vdb"}
#: Every sample that a bake may own.
NAME = re.compile(r"(samples/lam_\d{4,}|frames/frame_-?\d{4,})\.(usdc|exr|vdb)")


@dataclass(frozen=True)
class MeshIdentity:
    """The mesh a cache belongs to: SHA-256 of its vertices and triangles, and their counts for readable messages."""

    fingerprint: str
    vertices: int
    faces: int

    @classmethod
    def of(cls, mesh: MeshData) -> "MeshIdentity":
        return cls(mesh.fingerprint(), len(mesh.vertices), len(mesh.triangles))


@dataclass(frozen=True)
class Plan:
    """One bake: target usd, exr or vdb; axis "lambda" (times are λ in 0..1) or "frame" (times are frames, integer)."""

    target: str
    axis: str
    times: tuple[float, ...]
    mesh: MeshIdentity
    settings: Mapping[str, Json]

    @property
    def names(self) -> tuple[str, ...]:
        """One file per sample, relative to the folder."""
        extension = EXTENSIONS[self.target]
        if self.axis == "lambda":
            return tuple(f"samples/lam_{j:04d}.{extension}" for j in range(len(self.times)))
        # Blender finds a sequence by the digits before the extension, so a negative frame keeps its four digits.
        return tuple(f"frames/frame_{'-' if f < 0 else ''}{abs(int(f)):04d}.{extension}" for f in self.times)

    @property
    def time_codes(self) -> tuple[float, ...]:
        """USD time codes of the samples: λ · TIME_CODES_PER_LAMBDA, or the frame itself."""
        scale = TIME_CODES_PER_LAMBDA if self.axis == "lambda" else 1.0
        return tuple(scale * time for time in self.times)

    def folder_name(self, word: str) -> str:
        """A name that equal plans share and different ones do not: the same design finds its cache again."""
        return f"{word}-{hashlib.sha256(text(self).encode()).hexdigest()[:12]}"

    def same(self, other: "Plan") -> bool:
        """Whether both describe the same bake (settings as JSON sees them)."""
        return text(self) == text(other)

    def to_json(self) -> dict[str, Json]:
        return {
            "schema": f"{SCHEMA}/{VERSION}",
            "target": self.target,
            "axis": self.axis,
            "lambdas" if self.axis == "lambda" else "frames": list(self.times),
            "time_codes": list(self.time_codes),
            "mesh": {"fingerprint": self.mesh.fingerprint, "vertices": self.mesh.vertices, "faces": self.mesh.faces},
            "settings": dict(self.settings),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Json]) -> "Plan":
        axis = data["axis"]
        times = data["lambdas"] if axis == "lambda" else data["frames"]
        return cls(data["target"], axis, tuple(times), MeshIdentity(**data["mesh"]), data["settings"])


def text(plan: Plan, files: Mapping[str, str] | None = None) -> str:
    """JSON of a plan, or with files of a manifest; the same bytes for the same content."""
    data = plan.to_json() | ({} if files is None else {"files": dict(sorted(files.items()))})
    return json.dumps(data, indent=1, ensure_ascii=False, sort_keys=True, allow_nan=False) + "\n"
