# SPDX-License-Identifier: GPL-3.0-or-later
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

from ...analysis.colours import KIND_COLOURS, lam_colours
from ...analysis.entities import EntityGraph
from ...analysis.naming import named_graph, named_tracking
from ...analysis.tracking import Tracking
from ..nodes import entity_nodes
from ..read import results
from ..read.element_places import element_places
from ..read.results import ROLE, find_curves
from . import entity_lists, morse_faces
from .curve_objects import make_curves, remove_curves
from .following import follow_surface

#: Radius of the curves over the object's size.
RADIUS = 0.0015


def show_ecg(scene: bpy.types.Scene, obj: bpy.types.Object, graph: EntityGraph, shown_field: str) -> None:
    """Fixed points, orbits and separatrices of one λ: objects, list and graph. Raises RuntimeError without igraph."""
    collection = _collection(scene, obj)
    graph = named_graph(graph, element_places(obj))
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
    _curves(obj, collection, results.SEPARATRICES, lines, {"colour": colours}, {"source": source, "target": target})
    orbits = [entity for entity in entities if entity.curve is not None and len(entity.curve) > 2]
    _curves(
        obj,
        collection,
        results.ORBITS,
        [_opened(entity.curve) for entity in orbits],
        {"colour": [_blend(entity.kind, entity.kind, len(_opened(entity.curve))) for entity in orbits]},
        {
            "entity": np.array([entity.id for entity in orbits], np.int32),
            "kind": np.array([results.kind_number(entity.kind) for entity in orbits], np.int32),
        },
        cyclic=True,
    )
    _points(
        obj,
        collection,
        results.POINTS,
        np.array([entity.position for entity in entities]).reshape(-1, 3),
        {
            "entity": np.arange(len(entities), dtype=np.int32),
            "kind": np.array([results.kind_number(entity.kind) for entity in entities], np.int32),
            "strength": np.array([entity.strength for entity in entities], np.float32),
        },
    )
    entity_lists.fill_list(obj, "ecg", graph, shown_field)
    entity_nodes.show_graph(obj, "ecg", graph)


def show_tracking(scene: bpy.types.Scene, obj: bpy.types.Object, tracking: Tracking, shown_field: str) -> int:
    """Paths and bifurcations over λ: objects and list; how many paths the filter hides because there are very many.
    Timeline markers are timeline.update_markers'."""
    collection = _collection(scene, obj)
    tracking = named_tracking(tracking, element_places(obj))
    paths, events = tracking.paths, tracking.bifurcations
    # A curve of one point cannot be drawn: of a path of one sample only its bifurcations are drawn.
    drawn = [path for path in paths if len(path.lambdas) > 1]
    _curves(
        obj,
        collection,
        results.PATHS,
        [path.positions for path in drawn],
        {
            "lam": [path.lambdas for path in drawn],
            "colour": [lam_colours(path.lambdas) for path in drawn],
            "kind": [np.array([results.kind_number(kind) for kind in path.kinds], np.int32) for path in drawn],
        },
        {"entity": np.array([path.id for path in drawn], np.int32)},
    )
    _points(
        obj,
        collection,
        results.EVENTS,
        np.array([event.position for event in events]).reshape(-1, 3),
        {
            "entity": np.array([len(paths) + event.id for event in events], np.int32),
            "kind": np.array([results.kind_number(event.kind) for event in events], np.int32),
            "lam": np.array([event.lam for event in events], np.float32),
        },
    )
    return entity_lists.fill_history(obj, tracking, shown_field)


def show_morse(obj: bpy.types.Object, graph: EntityGraph, triangle_sets: np.ndarray, shown_field: str) -> None:
    """Morse sets of one λ: the faces' attribute, list and graph. Raises RuntimeError without igraph."""
    morse_faces.write(obj, triangle_sets)
    entity_lists.fill_list(obj, "mcg", graph, shown_field)
    entity_nodes.show_graph(obj, "mcg", graph)


def _collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> bpy.types.Collection:
    """The collection of an object's analysis, made when it is missing."""
    analysis = obj.stormfield.analysis
    collection = analysis.collection
    if collection is None or not _is_of(collection, obj):  # an object that was copied gets its own
        collection = bpy.data.collections.new(f"{obj.name} analysis")
        collection.hide_render = True
        analysis.collection = collection
    if collection not in scene.collection.children_recursive:
        scene.collection.children.link(collection)
    return collection


def _is_of(collection: bpy.types.Collection, obj: bpy.types.Object) -> bool:
    """Whether no other object's results are in the collection."""
    owners = {made.parent for made in collection.objects if made.get(ROLE) is not None}
    return not owners - {obj}


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
    made = results.find_points(role, obj)
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
    follow_surface(made)


def _hide(made: bpy.types.Object) -> None:
    """By its eye in the outliner, in every view layer that has it."""
    for scene in made.users_scene:
        for layer in scene.view_layers:
            layer.update()
            if made.name in layer.objects:
                made.hide_set(True, view_layer=layer)


def forget(obj: bpy.types.Object, lists: Sequence[str] = ("ecg", "history", "mcg")) -> None:
    """Remove an object's analysis: lists, node trees, objects, and the collection when nothing else is in it."""
    analysis = obj.stormfield.analysis
    roles = {
        "ecg": (results.SEPARATRICES, results.ORBITS, results.POINTS),
        "history": (results.PATHS, results.EVENTS),
        "mcg": (),
    }
    for which in lists:
        entities = analysis.list(which)
        entities.items.clear()
        entities.made = False
        tree = entity_nodes.tree_of(obj, which)
        if tree is not None:
            bpy.data.node_groups.remove(tree)
        for role in roles[which]:
            remove_curves(role, obj)
            points = results.find_points(role, obj)
            if points is not None:
                bpy.data.batch_remove([points.data, points])
    if "mcg" in lists:
        morse_faces.remove(obj.data)
    collection = analysis.collection
    if collection is not None and not collection.all_objects:
        bpy.data.collections.remove(collection)
    analysis.version += 1
