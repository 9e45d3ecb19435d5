# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object's field is out of date: elements, edits, mesh or settings have changed since they were solved.

    known = freshness.read(obj)         # when a solve begins
    freshness.keep(obj, known)          # when its field is attached: undo brings field and knowledge back together
    freshness.why_out_of_date(obj)      # "'Storm' was moved"; empty while the field is what a solve would give

The answer is kept until Blender reports a change, so that panels and draw handlers may ask at every redraw. The mesh is
looked at again only when Blender reports a change of the mesh itself.
"""

import json
import time
from dataclasses import dataclass, field

import bpy

from ..model.words import Json
from ..scene.read import freshness as reading
from ..scene.read.attached import LAMBDA, attached_folder, find_modifier
from ..scene.read.facts import values_of
from ..scene.read.topology import Fit, fit


@dataclass
class _Known:
    """The last answer for one object, and what it was given for."""

    asked: tuple = ()
    answer: str = ""
    mesh: dict[tuple, str] = field(default_factory=dict)  #: digest of the mesh, by its version
    settings: tuple = ()
    looked: tuple[int, float] = (-1, 0.0)  #: when settings were read: count of changes, seconds


#: Seconds between two looks at settings while Blender reports no change: a window draws often.
PAUSE = 0.0 if bpy.app.background else 0.25

_known: dict[int, _Known] = {}
_changes = 0
_meshes: dict[int, int] = {}  #: how often each mesh was changed, by its session uid


def mark_changed(depsgraph: bpy.types.Depsgraph) -> None:
    """Called after Blender has evaluated changes."""
    global _changes
    _changes += 1
    for update in depsgraph.updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Mesh):
            uid = update.id.original.session_uid
            _meshes[uid] = _meshes.get(uid, 0) + 1


def forget() -> None:
    _known.clear()
    _meshes.clear()


def read(obj: bpy.types.Object) -> dict[str, Json]:
    """What a solve reads now, for keep()."""
    return reading.read(obj)


def keep(obj: bpy.types.Object, known: dict[str, Json]) -> None:
    """Remember with the object what its field was solved from."""
    obj.stormfield.solve.solved = json.dumps(known)
    _known.pop(obj.session_uid, None)


def why_out_of_date(obj: bpy.types.Object) -> str:
    """What has changed since Solve; empty where nothing has, nothing was solved, or it is not known from what."""
    text = obj.stormfield.solve.solved
    if not text or attached_folder(obj, LAMBDA) is None:
        return ""
    known = _known.setdefault(obj.session_uid, _Known())
    asked = (_changes, text, _settings(obj), _mesh_version(obj.data))
    if known.asked != asked:
        known.asked, known.answer = asked, "; ".join(_changes_since(obj, json.loads(text), known))
    return known.answer


def elements_version(obj: bpy.types.Object) -> tuple:
    """Changes whenever elements may have changed; cheap enough for every redraw."""
    return _changes, _settings(obj)


def _changes_since(obj: bpy.types.Object, before: dict[str, Json], known: _Known) -> list[str]:
    version = _mesh_version(obj.data)
    if version not in known.mesh:
        known.mesh = {version: reading.mesh_digest(obj.data)}
    found = reading.changes(before, reading.read(obj, known.mesh[version]))
    return [_of_mesh(obj) if reason == reading.MESH_CHANGED else reason for reason in found]


def _of_mesh(obj: bpy.types.Object) -> str:
    """What became of the field on a mesh that was changed."""
    how = fit(find_modifier(obj, LAMBDA).cache_file, obj.data)
    if how is Fit.OTHER:
        return f"{reading.MESH_CHANGED}, so that the field is off"
    if how is Fit.SAME:  # its faces were flipped, or the field was transferred to it
        return reading.MESH_CHANGED
    return f"{reading.MESH_CHANGED}, and the field on it is approximate"


def _mesh_version(mesh: bpy.types.Mesh) -> tuple:
    counts = len(mesh.vertices), len(mesh.edges), len(mesh.loops), len(mesh.polygons)
    return mesh.session_uid, _meshes.get(mesh.session_uid, 0), *counts


def _settings(obj: bpy.types.Object) -> tuple:
    """What scripts may set without Blender's knowledge: looked at after each PAUSE."""
    known = _known.setdefault(obj.session_uid, _Known())
    now = time.monotonic()
    if known.looked[0] != _changes or now - known.looked[1] >= PAUSE:
        known.looked, known.settings = (_changes, now), _read_settings(obj)
    return known.settings


def _read_settings(obj: bpy.types.Object) -> tuple:
    field = obj.stormfield
    return (
        values_of(field.solve),
        tuple([(each.name, each.enabled, each.source, values_of(each)) for each in field.elements]),
        tuple([(edit.enabled, edit.loop, edit.axis_curve, values_of(edit)) for edit in field.edits]),
    )
