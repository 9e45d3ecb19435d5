# SPDX-License-Identifier: GPL-3.0-or-later
"""An EntityGraph as a node tree: one node in three rows for each entity that the list shows, and the links of these.

The classes of tree and node are in ui/graph_editor.py, which draws the links itself, from row to row: the sockets stay
hidden. Making a graph again replaces nodes and links and keeps the tree, so that editors that show it stay open.
"""

from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np

from ...analysis.colours import KIND_COLOURS
from ...analysis.entities import Entity, EntityGraph, Link
from ...analysis.layout import layout
from ...analysis.shown_graph import shown_graph

TREE, NODE = "StormfieldGraph", "StormfieldEntity"
#: What follows the object's name in that of its tree, which the editor's header shows.
NAMES = {"ecg": "now", "mcg": "regions"}
#: Width of a node: at least, at most, without its name, and of a letter.
WIDTH, WIDEST, FRAME, LETTER = 70.0, 200.0, 36.0, 7.0
#: Space between neighbours; distance of rows: at least, and over the graph's width.
GAP = 18.0
ROW, SLANT = 120.0, 0.12


def tree_of(obj: bpy.types.Object, which: str) -> bpy.types.NodeTree | None:
    """The node tree of an object's "ecg" or "mcg", if it was made. That of the object it was copied from is not its."""
    tree = getattr(obj.stormfield.analysis, f"{which}_tree", None)
    return tree if tree is not None and tree.owner == obj else None


def show_graph(obj: bpy.types.Object, which: str, graph: EntityGraph) -> bpy.types.NodeTree:
    """Make or replace the node tree of an object's graph, whose list is filled. Raises RuntimeError where igraph is
    missing."""
    tree: Any = tree_of(obj, which) or bpy.data.node_groups.new(f"{obj.name} {NAMES[which]}", TREE)
    setattr(obj.stormfield.analysis, f"{which}_tree", tree)
    tree.owner, tree.which, tree.title = obj, which, graph.title
    tree.whole = False
    for made in (tree.nodes, tree.routes, tree.drawn, tree.places):
        made.clear()
    for entity in graph.entities:
        known = tree.places.add()
        known.name, known.kind, known.row, known.shown = entity.name, entity.kind, entity.row, False
    for link in graph.links:
        item = tree.routes.add()
        item.source, item.target = graph.entities[link.source].name, graph.entities[link.target].name
    _arrange(tree, _passing(tree))
    return tree


def follow_filters(tree: bpy.types.NodeTree) -> None:
    """Show the entities that the filters of the list let through, and lay them out anew where these have changed."""
    shown = _passing(tree)
    if shown != [known.shown for known in tree.places]:
        _arrange(tree, shown)


def _passing(tree) -> list[bool]:
    """Per place whether the list shows it; of a list that is another's, all."""
    entities = tree.owner.stormfield.analysis.list(tree.which)
    if [item.name for item in entities.items] != [known.name for known in tree.places]:
        return [True] * len(tree.places)
    return [entities.passes(item) for item in entities.items]


def _arrange(tree, shown: list[bool]) -> None:
    part = shown_graph(_graph_of(tree), [i for i, keep in enumerate(shown) if keep])
    drawn = layout(part)
    step = width_for(entity.name for entity in part.entities) + GAP
    scale = np.array([step, max(ROW, SLANT * step * drawn.width)])
    tree.row = scale[1]
    for known, keep in zip(tree.places, shown, strict=True):
        known.shown = keep
    for entity, place in zip(part.entities, drawn.positions * scale, strict=True):
        tree.places[entity.name].place = place
    tree.drawn.clear()
    for link, route in zip(part.links, drawn.routes, strict=True):
        item = tree.drawn.add()
        item.source, item.target = part.entities[link.source].name, part.entities[link.target].name
        if len(route) == 3:
            item.bends, item.bend = True, route[1] * scale
    tree.whole = False
    tree.nodes.clear()
    make_whole(tree)


def _graph_of(tree) -> EntityGraph:
    """The whole graph, without the curves."""
    entities = [Entity(i, known.name, known.kind, known.row, np.zeros(3)) for i, known in enumerate(tree.places)]
    number = {entity.name: entity.id for entity in entities}
    links = [Link(number[route.source], number[route.target]) for route in tree.routes]
    return EntityGraph(tree.title, tuple(entities), tuple(links), 0.0)


def width_for(names: Iterable[str]) -> float:
    """Of all nodes of a graph, so that its longest name is read."""
    return min(WIDEST, max(WIDTH, FRAME + LETTER * max(map(len, names), default=0)))


def is_whole(tree: bpy.types.NodeTree) -> bool:
    """Whether each shown entity has its node and there are no others, as is so until an artist deletes or copies
    nodes."""
    return {node.name for node in tree.nodes} == {known.name for known in tree.places if known.shown}


def make_whole(tree: bpy.types.NodeTree) -> None:
    """One node for each shown entity, and the links: what is there stays, what is missing comes back, copies go.

    Nodes say what the field does. Deleting one would change nothing but what is seen."""
    tree.whole = False  # while it is worked on
    shown = {known.name for known in tree.places if known.shown}
    for node in [node for node in tree.nodes if node.name not in shown]:
        tree.nodes.remove(node)
    for entity, known in enumerate(tree.places):
        if known.shown and known.name not in tree.nodes:
            _new_node(tree, entity, known)
    linked = {(link.from_node.name, link.to_node.name) for link in tree.links}
    for route in tree.drawn:
        if (route.source, route.target) not in linked:
            tree.links.new(tree.nodes[route.target].inputs[0], tree.nodes[route.source].outputs[0])
    tree.whole = True


def _new_node(tree: bpy.types.NodeTree, entity: int, known) -> bpy.types.Node:
    node = tree.nodes.new(NODE)
    node.name, node.entity, node.kind = known.name, entity, known.kind
    node.label = known.name
    node.width = width_for(other.name for other in tree.places if other.shown)
    node.hide = True  # collapsed: it shows the entity's name alone
    node.location = (known.place[0] - 0.5 * node.width, known.place[1])
    node.use_custom_color, node.color = True, KIND_COLOURS.get(known.kind, KIND_COLOURS["other"])
    node.select = False
    return node


def select_node(tree: bpy.types.NodeTree, entity: int) -> None:
    """Make one entity's node the selected and active one; none where there is no such entity."""
    for node in tree.nodes:
        node.select = node.entity == entity
        if node.select:
            tree.nodes.active = node
