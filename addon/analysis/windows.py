# SPDX-License-Identifier: GPL-3.0-or-later
"""Tracking in windows of λ that share one sample, as parts that stitching.py joins. Between two samples the field is
linear, so a window needs nothing from outside.

    part = window_part(followed, mesh, lambdas, tangents)      # stitching.joined([("a", part), …])
    content = part_to_json(part)                               # what `stormfield track --from --to` writes
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any, get_args

import numpy as np

from .. import native
from ..model.words import FixedPointKind, Json
from .no_field import Region, region_without_field

SCHEMA = "stormfield.window/1"


#: Kinds of fixed points, which samples have by their place here: a month has tens of millions of samples.
KINDS = get_args(FixedPointKind)
#: What each sample of a path has, with its type.
COLUMNS: Mapping[str, type] = {
    "lambdas": np.float64,
    "faces": np.int32,
    "barycentric": np.float64,
    "positions": np.float64,
    "kinds": np.uint8,
}


def window_part(
    followed: native.Tracking, mesh: native.TriangleMesh, lambdas: np.ndarray, tangents: np.ndarray
) -> dict[str, Json]:
    """All paths of a window, unfiltered, with samples as arrays, and what joining needs: fingerprints of its ends,
    where it has no field."""
    return {
        "lam": [float(lam) for lam in lambdas],
        "ends": _fingerprints(mesh, tangents),
        "zero_vectors": [int(sample.size - np.count_nonzero(sample)) for sample in tangents],
        "still": _still(followed, mesh, tangents),
        "paths": [_path(path) for path in followed.paths],
        "bifurcations": [
            {
                "lam": event.lam,
                "face": event.face,
                "barycentric": event.barycentric.tolist(),
                "position": event.position.tolist(),
                "kind": event.kind,
                "node": event.node,
                "paths": list(event.paths),
            }
            for event in followed.bifurcations
        ],
    }


def part_to_json(part: dict[str, Json]) -> dict[str, Json]:
    """The part with plain values alone."""
    return {**part, "paths": [_plain(path) for path in part["paths"]]}


def part_from_json(content: dict[str, Json]) -> dict[str, Json]:
    """The part with samples as arrays."""
    return {**content, "paths": [{**path, **_columns(path)} for path in content["paths"]]}


def words_of(kinds: np.ndarray) -> list[FixedPointKind]:
    return [KINDS[kind] for kind in kinds]


def _plain(path: dict[str, Json]) -> dict[str, Json]:
    return {**path, **{key: path[key].tolist() for key in COLUMNS}, "kinds": words_of(path["kinds"])}


def _columns(path: dict[str, Json]) -> dict[str, np.ndarray]:
    numbers = {**path, "kinds": [KINDS.index(kind) for kind in path["kinds"]]}
    return {key: np.asarray(numbers[key], kind) for key, kind in COLUMNS.items()}


#: No changes of stability.
NONE: Mapping[str, Json] = {"lambdas": [], "faces": [], "barycentric": [], "positions": []}


def _fingerprints(mesh: native.TriangleMesh, tangents: np.ndarray) -> list[str]:
    """Of mesh and field at the first and the last sample: windows that share one have the same."""
    of_mesh = hashlib.sha256()
    for array in (mesh.triangles, mesh.vertices):
        of_mesh.update(np.ascontiguousarray(array).data)
    digests = []
    for sample in (tangents[0], tangents[-1]):
        digest = of_mesh.copy()
        digest.update(np.ascontiguousarray(sample).tobytes())
        digests.append(digest.hexdigest())
    return digests


def _path(path: Any) -> dict[str, Json]:
    return {
        "index": path.index,
        "begin": path.begin,
        "end": path.end,
        "strength": path.strength,
        "rotation": path.rotation,
        **_columns({key: getattr(path, key) for key in COLUMNS}),
        "margins": {
            **{name: getattr(path.margins, name) for name in ("first", "last", "first_certain", "last_certain")},
            **{name: _changes_json(getattr(path.margins, name)) for name in ("before", "after")},
        },
    }


def _changes_json(changes: Sequence[Any]) -> Mapping[str, Json]:
    if not changes:
        return NONE  # of nearly all paths: one for all of them
    return {
        "lambdas": [change.lam for change in changes],
        "faces": [change.face for change in changes],
        "barycentric": [change.barycentric.tolist() for change in changes],
        "positions": [change.position.tolist() for change in changes],
    }


# Where there is no field ----------------------------------------------------------------------------------------------


def _still(followed: native.Tracking, mesh: native.TriangleMesh, tangents: np.ndarray) -> dict[str, Json]:
    """Vertices, faces and whole parts without a field in all of the window, and corners of the faces that matter."""
    region = region_without_field(mesh, tangents)
    still = tangents == 0.0
    still = still if np.iscomplexobj(tangents) else still.all(axis=-1)
    vertices = still.all(axis=0)
    faces = np.flatnonzero(region.faces)
    held = np.unique(np.concatenate([faces, *(path.faces for path in followed.paths)])) if len(faces) else faces
    components = np.asarray(mesh.components)
    moving = np.unique(components[~vertices])
    return {
        "vertices": np.flatnonzero(vertices).tolist(),
        "faces": faces.tolist(),
        "parts": np.setdiff1d(np.unique(components), moving).tolist(),
        "corners": {str(face): region.triangles[face].tolist() for face in held},
        "counts": [int(mesh.vertex_count), int(mesh.face_count)],
    }


def common_region(parts: Sequence[Json]) -> Region:
    """Where no window has a field."""
    stills = [part["still"] for part in parts]
    vertex_count, face_count = stills[0]["counts"]

    def common(key: str) -> set[int]:
        return set.intersection(*(set(still[key]) for still in stills))

    faces, triangles = np.zeros(face_count, bool), np.zeros((face_count, 3), np.int32)
    faces[sorted(common("faces"))] = True
    for still in stills:
        for face, corners in still["corners"].items():
            triangles[int(face)] = corners
    vertices = np.zeros(vertex_count, bool)
    vertices[triangles[faces]] = True
    return Region(faces, vertices, triangles, len(common("parts")), len(common("vertices")))
