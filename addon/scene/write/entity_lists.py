# SPDX-License-Identifier: GPL-3.0-or-later
"""An analysis → the lists of its entities, for the panels, the graph editor and the overlay."""

from collections.abc import Sequence

import bpy
import numpy as np

from ...analysis import quiet
from ...analysis.entities import Entity, EntityGraph
from ...analysis.tracking import Bifurcation, TrackedPath, Tracking

#: Paths that are shown at first; the life span filter hides the others.
MAX_PATHS = 200

_BEGIN = {"first": "there from the start", "boundary": "enters at the boundary", "creation": "appears with another"}
_END = {"last": "stays to the end", "boundary": "leaves at the boundary", "annihilation": "vanishes with another"}


def fill_list(obj: bpy.types.Object, which: str, graph: EntityGraph, shown_field: str) -> None:
    """The list of a graph's entities, in its order."""
    entities = _new_list(obj, which, shown_field, graph.lam)
    for entity in graph.entities:
        item = entities.items.add()
        item.name, item.kind, item.row, item.position = entity.name, entity.kind, entity.row, entity.position
        item.strength, item.life = entity.strength, 1.0
        item.storm = bool(entity.info.get("storm", False))
        multiplier = entity.info.get("multiplier")
        if isinstance(multiplier, float):
            item.weight = quiet.orbit_weight(multiplier)
        item.note = _note(entity)
        item.faces = 0 if entity.faces is None else len(entity.faces)
    _list_is_full(obj, entities)


def fill_history(obj: bpy.types.Object, tracking: Tracking, shown_field: str) -> int:
    """The list of paths and bifurcations over λ; how many paths the filter hides because there are very many."""
    paths, events = tracking.paths, tracking.bifurcations
    entities = _new_list(obj, "history", shown_field)
    strongest = max((path.strength for path in paths), default=0.0)
    for path in paths:
        item = entities.items.add()
        item.weight, item.storm = quiet.path_weight(path, strongest), quiet.is_storm_path(path)
        item.name, item.kind, item.strength = path.name, path.kind, path.strength
        item.position = path.positions[len(path.positions) // 2]
        item.lam_start, item.lam_end, item.life = path.first, path.last, path.life
        item.note = f"{_BEGIN[path.begin]}, {_END[path.end]}"
    for event in events:
        item = entities.items.add()
        item.name, item.kind, item.row = _event_name(event, paths), event.kind, event.node
        item.position = event.position
        mine = [paths[index] for index in event.paths]
        item.note = event.title.capitalize()
        item.weight = quiet.event_weight(event, paths, strongest)
        item.words = quiet.storm_event(event, tracking)
        if item.words:
            item.name, item.note = item.words.capitalize(), f"{item.note}: {_event_name(event, paths)}"
        item.strength = max((path.strength for path in mine), default=0.0)
        # A bifurcation is as important as the most persistent of its paths; `lam` is where it happens.
        item.lam = event.lam
        item.life = max((path.life for path in mine), default=0.0)
    _list_is_full(obj, entities)
    return _hide_short_lived(entities, len(paths))


def _event_name(event: Bifurcation, paths: Sequence[TrackedPath]) -> str:
    """The fixed points it happens to, and what happens, in short."""
    names = " ".join(paths[index].name for index in event.paths)
    happens = {"creation": "appear", "annihilation": "vanish"}.get(event.kind, f"→ {event.node}")
    return f"{names} {happens}".strip()


def _hide_short_lived(entities, paths: int) -> int:
    """Where there are very many paths, set the filter so that the longest-lived MAX_PATHS show; how many it hides."""
    if paths <= MAX_PATHS:
        return 0
    lives = sorted((item.life for item in entities.items[:paths]), reverse=True)
    if lives[MAX_PATHS] < lives[0]:
        entities.min_life = max(entities.min_life, float(np.nextafter(np.float32(lives[MAX_PATHS]), np.float32(2.0))))
    return sum(life < entities.min_life for life in lives)


def _note(entity: Entity) -> str:
    """What matters of an entity's further numbers, in words with units."""
    words = []
    for key, unit in (("length", " long"), ("period", " s per turn"), ("multiplier", "× per turn"), ("area", " area")):
        if isinstance(entity.info.get(key), int | float):
            words.append(f"{entity.info[key]:.3g}{unit}")
    if isinstance(entity.info.get("persistence"), float):
        words.append(f"persistence {entity.info['persistence']:.3g}")
    if "conley" in entity.info:
        words.append("Conley index " + ", ".join(str(b) for b in entity.info["conley"]))
    return "; ".join(words)


def _new_list(obj, which: str, shown_field: str, lam: float = 0.0):
    entities = obj.stormfield.analysis.list(which)
    entities.items.clear()
    entities.made, entities.lam, entities.shown_field = True, lam, shown_field
    return entities


def _list_is_full(obj, entities) -> None:
    entities.strongest = max((item.strength for item in entities.items), default=0.0)
    entities.active = -1
    obj.stormfield.analysis.version += 1
