# SPDX-License-Identifier: GPL-3.0-or-later
"""One selected entity, wherever it was chosen: it is the list's active item, and graph and view follow that.

selection.select(obj, "ecg", 3)        # from the view, or a script
selection.follow_graph(tree)           # from the graph editor: the list takes over the active node
"""

import bpy

from ..nodes import entity_nodes


def select(obj: bpy.types.Object, which: str, index: int) -> None:
    """Select an entity of a list ("ecg", "history", "mcg") and show that list."""
    analysis = obj.stormfield.analysis
    analysis.shown = which
    analysis.list(which).active = index  # its update does the rest


def list_changed(obj: bpy.types.Object, which: str) -> None:
    """The list's active item has changed: let the graph and all views follow."""
    analysis = obj.stormfield.analysis
    tree = entity_nodes.tree_of(obj, which)
    if tree is not None:
        entity_nodes.select_node(tree, analysis.list(which).active)
    redraw()


def follow_graph(obj: bpy.types.Object, which: str) -> bool:
    """Take the graph's active node over into the list; whether that changed anything."""
    tree = entity_nodes.tree_of(obj, which)
    node = tree.nodes.active if tree is not None else None
    if node is None or not node.select or node.entity == obj.stormfield.analysis.list(which).active:
        return False
    select(obj, which, node.entity)
    return True


def redraw() -> None:
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type in {"VIEW_3D", "NODE_EDITOR"}:
                    area.tag_redraw()
