# SPDX-License-Identifier: GPL-3.0-or-later
"""Bifurcations as timeline markers, at the frames where λ passes them.

Only markers that an earlier call made are replaced; the object's analysis remembers their names and frames. A marker
that was renamed or moved belongs to the artist.
"""

import json
from collections.abc import Sequence

import bpy

from ..read.lambda_seen import passages
from ..read.lambda_source import plain_keys
from ..read.results import EVENT_KINDS

_BACKWARDS = {"creation": "annihilation", "annihilation": "creation"}
_WORDS_BACKWARDS = {"storms merge": "storm splits", "storm splits": "storms merge"}


def marker_name(kind: str, node: str, lam: float, forward: bool = True, words: str = "") -> str:
    """What happens, in the direction in which λ runs: "λ 0.42 saddle + sink annihilate", or in an artist's `words`:
    "λ 0.60 storms merge"."""
    if words:
        return f"λ {lam:.2f} {words if forward else _WORDS_BACKWARDS[words]}"
    if kind == "hopf":
        other = {"source": "sink", "sink": "source"}.get(node, node)
        return f"λ {lam:.2f} becomes {node if forward else other}"
    happens = kind if forward else _BACKWARDS[kind]
    return f"λ {lam:.2f} saddle + {node} {'appear' if happens == 'creation' else 'annihilate'}"


def update_markers(obj: bpy.types.Object) -> int:
    """Markers of all bifurcations that the filters of the list let through, instead of earlier ones; their number. Goes
    through the scene's frames where λ does not come from plain keys."""
    events = _events(obj)
    found = passages(bpy.context, obj, [item.lam for item in events])
    obj.stormfield.analysis.passages = json.dumps(found)
    return _make(obj, found)


def filter_markers(obj: bpy.types.Object) -> int:
    """The same after the filters have changed, quickly: what was found by going through the frames counts again."""
    known = json.loads(obj.stormfield.analysis.passages or "[]")
    if plain_keys(obj) is None and len(known) == len(_events(obj)):
        return _make(obj, known)
    return update_markers(obj)


def _events(obj: bpy.types.Object) -> list:
    return [item for item in obj.stormfield.analysis.history.items if item.kind in EVENT_KINDS]


def _make(obj: bpy.types.Object, found: Sequence[Sequence[tuple[int, bool]]]) -> int:
    scene = bpy.context.scene if bpy.context.scene in obj.users_scene else next(iter(obj.users_scene), None)
    if scene is None:
        return 0
    remove_markers(obj)
    made = []
    for item, places in zip(_events(obj), found, strict=True):
        if not obj.stormfield.analysis.history.passes(item):
            continue
        for frame, forward in places:
            marker = scene.timeline_markers.new(
                marker_name(item.kind, item.row, item.lam, forward, item.words), frame=frame
            )
            made.append((marker.name, frame))
    obj.stormfield.analysis.markers = json.dumps(made, ensure_ascii=False)
    return len(made)


def remove_markers(obj: bpy.types.Object) -> None:
    text = obj.stormfield.analysis.markers
    if not text:
        return
    mine = [(name, frame) for name, frame in json.loads(text)]
    for scene in obj.users_scene:
        for marker in list(scene.timeline_markers):
            if (marker.name, marker.frame) in mine:
                mine.remove((marker.name, marker.frame))
                scene.timeline_markers.remove(marker)
    obj.stormfield.analysis.markers = ""
