"""An analysis → objects of the collection '<object> analysis', entities of the lists, and node trees.

Curves and points are ordinary objects with attributes, for renders and Geometry Nodes: `entity` is the place in the
list, `kind` the number of the kind in KINDS, `lam` is λ, `colour` what the overlay shows. An update replaces what an
earlier one made, in the same objects, and never adds a second. The collection is left out of renders, and its objects
are hidden in the view, where the overlay draws them, until the artist shows them.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import bpy
import numpy as np

from ..analysis.entities import KIND_COLOURS, Entity, EntityGraph
from ..analysis.tracking import Bifurcation, TrackedPath, Tracking
from . import entity_nodes, morse_faces
from .curve_objects import ROLE, find_curves, make_curves, remove_curves

SEPARATRICES, ORBITS, POINTS = "Separatrices", "Periodic Orbits", "Entities"
PATHS, EVENTS = "Singularity Paths", "Bifurcations"
EVENT_KINDS = frozenset({"creation", "annihilation", "hopf"})
KINDS = (*KIND_COLOURS, "creation", "annihilation", "hopf")
#: Custom property of the collection: the name of the mesh object.
OWNER = "stormfield_owner"
#: Radius of the curves, as a part of the object's size.
RADIUS = 0.0015
#: Paths that are shown at first; the life span filter hides the others.
MOST_PATHS = 200
#: λ = 0 … 1 on paths: dark violet, magenta, orange, pale yellow.
RAMP = np.array([(0.27, 0.10, 0.50), (0.72, 0.16, 0.50), (0.96, 0.46, 0.24), (0.99, 0.93, 0.62)])


def lam_colours(lam: np.ndarray) -> np.ndarray:
    """(k, 4) colours of λ in 0..1."""
    at = np.linspace(0.0, 1.0, len(RAMP))
    return np.stack([*(np.interp(lam, at, RAMP[:, c]) for c in range(3)), np.ones(len(lam))], axis=1)


def kind_number(kind: str) -> int:
    return KINDS.index(kind) if kind in KINDS else KINDS.index("other")


# Into Blender ---------------------------------------------------------------------------------------------------------


def show_ecg(scene: bpy.types.Scene, obj: bpy.types.Object, graph: EntityGraph, shown_field: str) -> None:
    """Fixed points, orbits and separatrices of one λ: objects, list and graph. Raises RuntimeError without igraph."""
    collection = _collection(scene, obj)
    entities = graph.entities
    lines, ends = [], []
    for link in graph.links:
        for curve in link.curves:
            if len(curve) > 1:
                lines.append(np.asarray(curve))
                ends.append((link.source, link.target))
    source = np.array([a for a, _ in ends], np.int32)
    target = np.array([b for _, b in ends], np.int32)
    colours = [_blend(entities[a].kind, entities[b].kind, len(line)) for line, (a, b) in zip(lines, ends, strict=True)]
    _curves(obj, collection, SEPARATRICES, lines, {"colour": colours}, {"source": source, "target": target})
    orbits = [entity for entity in entities if entity.curve is not None and len(entity.curve) > 2]
    _curves(
        obj,
        collection,
        ORBITS,
        [_opened(entity.curve) for entity in orbits],
        {"colour": [_blend(entity.kind, entity.kind, len(_opened(entity.curve))) for entity in orbits]},
        {
            "entity": np.array([entity.id for entity in orbits], np.int32),
            "kind": np.array([kind_number(entity.kind) for entity in orbits], np.int32),
        },
        cyclic=True,
    )
    _points(
        obj,
        collection,
        POINTS,
        np.array([entity.position for entity in entities]).reshape(-1, 3),
        {
            "entity": np.arange(len(entities), dtype=np.int32),
            "kind": np.array([kind_number(entity.kind) for entity in entities], np.int32),
            "strength": np.array([entity.strength for entity in entities], np.float32),
        },
    )
    fill_list(obj, "ecg", graph, shown_field)
    entity_nodes.show_graph(obj, "ecg", graph)


def show_tracking(scene: bpy.types.Scene, obj: bpy.types.Object, tracking: Tracking, shown_field: str) -> int:
    """Paths and bifurcations over λ: objects and list; how many paths the filter hides because there are very many.
    Timeline markers are timeline.update_markers'."""
    collection = _collection(scene, obj)
    paths, events = tracking.paths, tracking.bifurcations
    # A curve of one point cannot be drawn: a path that lives for a moment is its bifurcations.
    drawn = [path for path in paths if len(path.lambdas) > 1]
    _curves(
        obj,
        collection,
        PATHS,
        [path.positions for path in drawn],
        {
            "lam": [path.lambdas for path in drawn],
            "colour": [lam_colours(path.lambdas) for path in drawn],
            "kind": [np.array([kind_number(kind) for kind in path.kinds], np.int32) for path in drawn],
        },
        {"entity": np.array([path.id for path in drawn], np.int32)},
    )
    _points(
        obj,
        collection,
        EVENTS,
        np.array([event.position for event in events]).reshape(-1, 3),
        {
            "entity": np.array([len(paths) + event.id for event in events], np.int32),
            "kind": np.array([kind_number(event.kind) for event in events], np.int32),
            "lam": np.array([event.lam for event in events], np.float32),
        },
    )
    entities = _new_list(obj, "history", shown_field)
    for path in paths:
        item = entities.items.add()
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
        item.strength = max((path.strength for path in mine), default=0.0)
        # A bifurcation is as important as the most persistent of its paths; `lam` is where it happens.
        item.lam = event.lam
        item.life = max((path.life for path in mine), default=0.0)
    _list_is_full(obj, entities)
    return _hide_short_lived(entities, len(paths))


def _event_name(event: Bifurcation, paths: Sequence[TrackedPath]) -> str:
    """Short: whom it befalls, and what."""
    whom = " ".join(paths[index].name for index in event.paths)
    happens = {"creation": "appear", "annihilation": "vanish"}.get(event.kind, f"→ {event.node}")
    return f"{whom} {happens}".strip()


def _hide_short_lived(entities, paths: int) -> int:
    """Where there are very many paths, set the filter so that the longest-lived MOST_PATHS show; how many it hides."""
    if paths <= MOST_PATHS:
        return 0
    lives = sorted((item.life for item in entities.items[:paths]), reverse=True)
    if lives[MOST_PATHS] < lives[0]:
        entities.min_life = max(entities.min_life, float(np.nextafter(np.float32(lives[MOST_PATHS]), np.float32(2.0))))
    return sum(life < entities.min_life for life in lives)


_BEGIN = {"first": "there from the start", "boundary": "enters at the boundary", "creation": "appears with another"}
_END = {"last": "stays to the end", "boundary": "leaves at the boundary", "annihilation": "vanishes with another"}


def show_morse(obj: bpy.types.Object, graph: EntityGraph, triangle_sets: np.ndarray, shown_field: str) -> None:
    """Morse sets of one λ: the faces' attribute, list and graph. Raises RuntimeError without igraph."""
    morse_faces.write(obj.data, triangle_sets)
    fill_list(obj, "mcg", graph, shown_field)
    entity_nodes.show_graph(obj, "mcg", graph)


def fill_list(obj: bpy.types.Object, which: str, graph: EntityGraph, shown_field: str) -> None:
    """The list of a graph's entities, in its order."""
    entities = _new_list(obj, which, shown_field, graph.lam)
    for entity in graph.entities:
        item = entities.items.add()
        item.name, item.kind, item.row, item.position = entity.name, entity.kind, entity.row, entity.position
        item.strength, item.life = entity.strength, 1.0
        item.note = _note(entity)
        item.faces = 0 if entity.faces is None else len(entity.faces)
    _list_is_full(obj, entities)


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


def _collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> bpy.types.Collection:
    """The collection of an object's analysis, made when it is missing."""
    analysis = obj.stormfield.analysis
    collection = analysis.collection
    if collection is None or collection.get(OWNER) != obj.name:  # an object that was copied gets its own
        collection = bpy.data.collections.new(f"{obj.name} analysis")
        collection.hide_render = True
        collection[OWNER] = obj.name
        analysis.collection = collection
    if collection not in scene.collection.children_recursive:
        scene.collection.children.link(collection)
    return collection


def _blend(start: str, end: str, count: int) -> np.ndarray:
    """(count, 4): from one kind's colour to the other's."""
    a, b = (np.array(KIND_COLOURS.get(kind, KIND_COLOURS["other"])) for kind in (start, end))
    along = np.linspace(0.0, 1.0, count)[:, None]
    return np.c_[a * (1 - along) + b * along, np.ones(count)]


def _opened(curve: np.ndarray) -> np.ndarray:
    """A closed polyline without its repeated point."""
    return curve[:-1] if np.allclose(curve[0], curve[-1]) else curve


def _curves(obj, collection, role, lines, attributes, per_curve, cyclic=False) -> None:
    if not lines:
        remove_curves(role, obj)
        return
    fresh = find_curves(role, obj) is None
    size = float(np.linalg.norm(np.ptp(np.array([corner[:] for corner in obj.bound_box]), axis=0)))
    made = make_curves(
        role,
        lines,
        attributes,
        radius=RADIUS * size,
        cyclic=np.full(len(lines), cyclic),
        curve_attributes=per_curve,
        parent=obj,
        collection=collection,
    )
    if fresh:
        _hide(made)


def _points(obj, collection, role: str, positions: np.ndarray, attributes: Mapping[str, np.ndarray]) -> None:
    """Loose vertices with attributes, under the mesh object."""
    made = find_points(role, obj)
    mesh: Any = made.data if made is not None else bpy.data.meshes.new(f"{obj.name} {role}")
    if made is None:
        made = bpy.data.objects.new(mesh.name, mesh)
        made[ROLE], made.parent = role, obj
        collection.objects.link(made)
        _hide(made)
    mesh.clear_geometry()
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    for name, values in attributes.items():
        kind = "INT" if values.dtype.kind == "i" else "FLOAT"
        attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
        if len(values):
            attribute.data.foreach_set("value", values)
    mesh.update_tag()


def _hide(made: bpy.types.Object) -> None:
    """By its eye in the outliner, in every view layer that has it."""
    for scene in made.users_scene:
        for layer in scene.view_layers:
            layer.update()
            if made.name in layer.objects:
                made.hide_set(True, view_layer=layer)


def find_points(role: str, obj: bpy.types.Object) -> bpy.types.Object | None:
    made = (other for other in obj.children if other.type == "MESH" and other.get(ROLE) == role)
    return next(made, None)


# Out of Blender -------------------------------------------------------------------------------------------------------


def read_curves(obj: bpy.types.Object, role: str) -> list[np.ndarray]:
    """The points of every curve of a role, (k, 3) each, as the file holds them; none where there is no such object."""
    made = find_curves(role, obj)
    if made is None or not len(made.data.curves):
        return []
    data = made.data
    points = _read(data.attributes["position"], "vector", 3)
    sizes = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("points_length", sizes)
    return np.split(points, np.cumsum(sizes)[:-1])


def read_attribute(obj: bpy.types.Object, role: str, name: str) -> np.ndarray:
    """One attribute of a role's curves or of their points, flat; empty where there is none."""
    made = find_curves(role, obj)
    attribute = made.data.attributes.get(name) if made is not None else None
    if attribute is None:
        return np.zeros(0, np.int32)
    if attribute.data_type == "FLOAT_COLOR":
        return _read(attribute, "color", 4)
    return _read(attribute, "value", 1, np.int32 if attribute.data_type == "INT" else np.float32)


def _read(attribute, key: str, width: int, number=np.float32) -> np.ndarray:
    values = np.empty(len(attribute.data) * width, number)
    attribute.data.foreach_get(key, values)
    return values.reshape(-1, width) if width > 1 else values


def forget(obj: bpy.types.Object, lists: Sequence[str] = ("ecg", "history", "mcg")) -> None:
    """Remove an object's analysis: lists, node trees, objects, and the collection when nothing else is in it."""
    analysis = obj.stormfield.analysis
    roles = {"ecg": (SEPARATRICES, ORBITS, POINTS), "history": (PATHS, EVENTS), "mcg": ()}
    for which in lists:
        entities = analysis.list(which)
        entities.items.clear()
        entities.made = False
        tree = entity_nodes.tree_of(obj, which)
        if tree is not None:
            bpy.data.node_groups.remove(tree)
        for role in roles[which]:
            remove_curves(role, obj)
            points = find_points(role, obj)
            if points is not None:
                bpy.data.batch_remove([points.data, points])
    if "mcg" in lists:
        morse_faces.remove(obj.data)
    collection = analysis.collection
    if collection is not None and not collection.all_objects:
        bpy.data.collections.remove(collection)
    analysis.version += 1
