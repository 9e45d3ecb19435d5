# SPDX-License-Identifier: GPL-3.0-or-later
"""The manifest that certifies a cache: its plan, and the SHA-256 of every file.

It is the last file that a bake writes: where it is, the cache is whole (docs/architecture.md, decision 7).
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..model.errors import InputError
from ..model.words import Json
from .layout import EDITS, OLD_CLIPS, OLD_MESH, OLD_STAGE, STAGE
from .plan import NAME, SCHEMA, VERSION, Plan

#: Files that join the samples.
SHARED = (STAGE, EDITS, OLD_STAGE, OLD_MESH, OLD_CLIPS)


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
    if not isinstance(files, dict) or any(not _is_known(name) for name in files):
        raise InputError(f"{path}: not a whole manifest; bake again")
    return Manifest(plan, files)


def _is_known(name: str) -> bool:
    """Whether a relative name can be a file of a cache."""
    return name in SHARED or NAME.fullmatch(name) is not None


def _load(path: Path) -> dict[str, Json]:
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


def _plan(data: dict[str, Json], path: Path) -> Plan:
    try:
        return Plan.from_json(data)
    except (KeyError, TypeError) as error:
        raise InputError(f"{path}: incomplete ({error}); bake again") from error
