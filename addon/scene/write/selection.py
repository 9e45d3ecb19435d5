# SPDX-License-Identifier: GPL-3.0-or-later
"""One selected entity, wherever it was chosen: it is the list's active item, and graph and view follow that.

selection.select(obj, "ecg", 3)        # from the view, or a script
selection.follow_graph(tree)           # from the graph editor: the list takes over the active node

The same for design elements: selection.show_element(obj) from the list, selection.follow_view(...) from the view.
"""

import bpy

from ..nodes import entity_nodes


def select(obj: bpy.types.Object, which: str, index: int) -> None:
    """Select an entity of a list ("ecg", "history", "mcg") and show that list."""
    analysis = obj.stormfield.analysis
    analysis.shown = which
    analysis.list(which).active = index  # its update does the rest


def extend(obj: bpy.types.Object, which: str, index: int) -> None:
    """Select an entity besides the active one, as Shift does; the new one is the active one. The graph holds both."""
    tree, before = entity_nodes.tree_of(obj, which), obj.stormfield.analysis.list(which).active
    select(obj, which, index)
    for node in tree.nodes if tree is not None else ():
        if node.entity == before:
            node.select = True


def list_changed(obj: bpy.types.Object, which: str) -> None:
    """The list's active item has changed: let the graph and all views follow."""
    analysis = obj.stormfield.analysis
    tree = entity_nodes.tree_of(obj, which)
    if tree is not None:
        entity_nodes.select_node(tree, analysis.list(which).active)
    redraw()


def filters_changed(obj: bpy.types.Object) -> None:
    """What the lists show has changed: let graphs and views follow."""
    for which in ("ecg", "mcg"):
        tree = entity_nodes.tree_of(obj, which)
        if tree is not None:
            entity_nodes.follow_filters(tree)
            entity_nodes.select_node(tree, obj.stormfield.analysis.list(which).active)
    redraw()


def follow_graph(obj: bpy.types.Object, which: str) -> bool:
    """Take the graph's active node over into the list; whether that changed anything. The rest stays selected."""
    tree = entity_nodes.tree_of(obj, which)
    node = tree.nodes.active if tree is not None else None
    if node is None or not node.select or node.entity == obj.stormfield.analysis.list(which).active:
        return False
    together = [other.name for other in tree.nodes if other.select]
    select(obj, which, node.entity)
    for name in together:
        tree.nodes[name].select = True
    return True


def show_element(obj: bpy.types.Object) -> None:
    """The artist clicked an element in the list: select its source in the view. Scripts that set the list's active
    element change no selection."""
    region = bpy.context.region
    if region is not None and region.type == "UI":
        select_source(obj)


def select_source(obj: bpy.types.Object) -> None:
    """Select the source of the list's active element, in Object Mode."""
    layer, element = bpy.context.view_layer, obj.stormfield.active()
    source = element.source if element is not None else None
    if source is None or source.name not in layer.objects:
        return
    if bpy.context.mode != "OBJECT" or (layer.objects.active == source and source.select_get()):
        return
    for other in bpy.context.selected_objects:
        other.select_set(False)
    source.hide_set(False)
    source.select_set(True)
    layer.objects.active = source


def follow_view(active: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """The artist clicked the source of an element in the view: make it the active one of its list."""
    for obj in scene.objects:
        if obj.type != "MESH" or not obj.stormfield.enabled:
            continue
        field = obj.stormfield
        current = field.active()
        if current is not None and current.source == active:
            continue
        found = next((i for i, element in enumerate(field.elements) if element.source == active), None)
        if found is not None:
            field.active_element = found


def redraw() -> None:
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type in {"VIEW_3D", "NODE_EDITOR"}:
                    area.tag_redraw()
