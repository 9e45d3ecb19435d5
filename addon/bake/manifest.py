"""What a cache folder holds: the plan of a bake, and the manifest that certifies it (decision 7).

The plan is everything known before the first sample is written; two bakes with equal plans write equal bytes, on any
machine. The manifest is the plan and the SHA-256 of every file, and is the last file written: where it is, the cache is
whole. Names in both are relative to the folder, with forward slashes, and follow NAME; nothing else is ever deleted.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..model.errors import InputError

SCHEMA = "stormfield.cache"
VERSION = 1

MANIFEST = "manifest.json"
PLAN = "plan.json"
SHARED = ("field.usda", "mesh.usdc", "clips.usda")
#: Targets of a bake, and the files of their samples.
EXTENSIONS = {"usd": "usdc", "exr": "exr", "vdb": "vdb"}
#: Every file a bake may own, besides MANIFEST and PLAN.
NAME = re.compile(r"(samples/lam_\d{4,}|frames/frame_-?\d{4,})\.(usdc|exr|vdb)")


@dataclass(frozen=True)
class MeshIdentity:
    """The mesh a cache belongs to: SHA-256 of its vertices and triangles, and their counts for readable messages."""

    fingerprint: str
    vertices: int
    faces: int

    @classmethod
    def of(cls, mesh) -> "MeshIdentity":
        return cls(mesh.fingerprint(), len(mesh.vertices), len(mesh.triangles))


@dataclass(frozen=True)
class Plan:
    """One bake: target usd, exr or vdb; axis "lambda" (times are λ in 0..1) or "frame" (times are frames, integer)."""

    target: str
    axis: str
    times: tuple[float, ...]
    mesh: MeshIdentity
    settings: Mapping[str, Any]

    @property
    def names(self) -> tuple[str, ...]:
        """One file per sample, relative to the folder."""
        extension = EXTENSIONS[self.target]
        if self.axis == "lambda":
            return tuple(f"samples/lam_{j:04d}.{extension}" for j in range(len(self.times)))
        # Blender finds a sequence by the digits before the extension, so a negative frame keeps its four digits.
        return tuple(f"frames/frame_{'-' if f < 0 else ''}{abs(int(f)):04d}.{extension}" for f in self.times)

    def same(self, other: "Plan") -> bool:
        """Whether both describe the same bake (settings as JSON sees them)."""
        return text(self) == text(other)

    def to_json(self) -> dict[str, Any]:
        return {
            "schema": f"{SCHEMA}/{VERSION}",
            "target": self.target,
            "axis": self.axis,
            "lambdas" if self.axis == "lambda" else "frames": list(self.times),
            "time_codes": list(time_codes(self)),
            "mesh": {"fingerprint": self.mesh.fingerprint, "vertices": self.mesh.vertices, "faces": self.mesh.faces},
            "settings": dict(self.settings),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> "Plan":
        axis = data["axis"]
        times = data["lambdas"] if axis == "lambda" else data["frames"]
        return cls(data["target"], axis, tuple(times), MeshIdentity(**data["mesh"]), data["settings"])


def time_codes(plan: Plan) -> tuple[float, ...]:
    """USD time codes of the samples: λ · 1000, or the frame itself."""
    return tuple(1000.0 * t for t in plan.times) if plan.axis == "lambda" else tuple(float(t) for t in plan.times)


@dataclass(frozen=True)
class Manifest:
    plan: Plan
    files: Mapping[str, str]  #: name -> SHA-256, hexadecimal


def read_plan(path: Path) -> Plan:
    return _plan(_load(path), path)


def read_manifest(path: Path) -> Manifest:
    data = _load(path)
    plan = _plan(data, path)
    files = data.get("files")
    if not isinstance(files, dict) or any(not known(name) for name in files):
        raise InputError(f"{path}: not a whole manifest; bake again")
    return Manifest(plan, files)


def text(plan: Plan, files: Mapping[str, str] | None = None) -> str:
    """JSON of a plan, or with files of a manifest; the same bytes for the same content."""
    data = plan.to_json() | ({} if files is None else {"files": dict(sorted(files.items()))})
    return json.dumps(data, indent=1, ensure_ascii=False, sort_keys=True, allow_nan=False) + "\n"


def known(name: str) -> bool:
    """Whether a relative name can be a file of a cache."""
    return name in SHARED or NAME.fullmatch(name) is not None


def _load(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"{path.parent}: no finished cache here ({path.name} is missing); solve or bake first"
        ) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise InputError(f"{path}: not JSON ({error}); bake again") from error
    schema = data.get("schema") if isinstance(data, dict) else None
    name, _, version = str(schema).partition("/")
    if name != SCHEMA or not version.isdigit():
        raise InputError(f"{path}: schema is {schema!r}, not {SCHEMA}/{VERSION}; this is not a Stormfield cache")
    if int(version) > VERSION:
        raise InputError(
            f"{path}: the cache has schema {schema}, newer than {SCHEMA}/{VERSION} of this Stormfield; "
            "update Stormfield, or bake again"
        )
    return data


def _plan(data: dict[str, Any], path: Path) -> Plan:
    try:
        return Plan.from_json(data)
    except (KeyError, TypeError) as error:
        raise InputError(f"{path}: incomplete ({error}); bake again") from error
