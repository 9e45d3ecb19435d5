# SPDX-License-Identifier: GPL-3.0-or-later
"""The graph editor: entity and Morse connection graphs as a node tree of their own, drawn from row to row.

Blender draws the nodes; links are drawn here, from the bottom of a node to the top of the next, in colours that fade
from one entity to the other. Those of the selected entity stand out. The editor shows the graph of the active field by
itself. Nothing is written while drawing: a timer takes a clicked node over into the list, right after.
"""

import bpy
import gpu
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from gpu_extras.batch import batch_for_shader

from .. import compat
from ..operators.edit_choice import why_not_cancel
from ..scene.nodes import entity_nodes
from ..scene.read.active_field import active_field
from ..scene.write import selection
from ..session import objects
from . import icons, palette
from .entity_details import draw_entity

#: Height of a collapsed node, in its tree's units.
NODE_HEIGHT = 20.0
#: Pieces of a link's curve.
PIECES = 16
_handle = None


class RouteItem(bpy.types.PropertyGroup):
    """A link between two entities by name; as it is drawn, through a bend where it passes the saddles."""

    source: StringProperty()
    target: StringProperty()
    bends: BoolProperty()
    bend: FloatVectorProperty(size=2)


class PlaceItem(bpy.types.PropertyGroup):
    """An entity with its place in the graph, in the order of the list; its name is that of its node."""

    kind: StringProperty()
    row: StringProperty()
    shown: BoolProperty(description="Whether the filters of the list let it through")
    place: FloatVectorProperty(size=2)


class StormfieldGraph(bpy.types.NodeTree):
    """Graph of the entities: repelling ones above, saddles between, attracting ones below; links go with the flow"""

    bl_idname = entity_nodes.TREE
    bl_label = "Stormfield Graph"
    bl_icon = "NODETREE"

    owner: PointerProperty(type=bpy.types.Object, name="Object", description="Mesh whose field this graph describes")
    which: StringProperty(description="ecg or mcg")
    title: StringProperty()
    row: FloatProperty(description="Distance of the rows (units of the tree)")
    routes: CollectionProperty(type=RouteItem, description="All links")
    drawn: CollectionProperty(type=RouteItem, description="Those between what is shown")
    places: CollectionProperty(type=PlaceItem)
    whole: BoolProperty(description="Whether nodes are as they were made, and not being made")

    def update(self):
        """Blender calls this when nodes or links were added or removed: nodes that were deleted come back."""
        if self.whole and not entity_nodes.is_whole(self):
            _repair_soon(self.session_uid)

    @classmethod
    def get_from_context(cls, context):
        """The editor follows the active field, unless it is pinned."""
        obj = active_field(context)
        if obj is None:
            return None, None, None
        return shown_tree(obj), obj, obj


def shown_tree(obj: bpy.types.Object) -> bpy.types.NodeTree | None:
    """The graph of the analysis that is listed; without one, the other."""
    analysis = obj.stormfield.analysis
    trees = (analysis.mcg_tree, analysis.ecg_tree)
    if analysis.shown != "mcg":
        trees = trees[::-1]
    return trees[0] or trees[1]


class StormfieldEntity(bpy.types.Node):
    bl_idname = entity_nodes.NODE
    bl_label = "Entity"
    bl_width_min, bl_width_default, bl_width_max = 40.0, entity_nodes.WIDTH, entity_nodes.WIDEST

    entity: IntProperty(description="Place in the list")
    kind: StringProperty(description="source, sink, saddle, ...")

    @classmethod
    def poll(cls, tree):
        return tree.bl_idname == entity_nodes.TREE

    def init(self, _context):
        for socket in (
            self.inputs.new("NodeSocketFloat", "From", use_multi_input=True),
            self.outputs.new("NodeSocketFloat", "To"),
        ):
            socket.enabled = False

    def draw_buttons(self, _context, layout):
        layout.label(text=self.kind.title(), icon_value=icons.of(self.kind))


class STORMFIELD_PT_graph_entity(bpy.types.Panel):
    bl_idname = "STORMFIELD_PT_graph_entity"
    bl_label = "Entity"
    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Stormfield"

    @classmethod
    def poll(cls, context):
        tree = context.space_data.edit_tree
        return tree is not None and tree.bl_idname == entity_nodes.TREE and tree.owner is not None

    def draw(self, context):
        tree = context.space_data.edit_tree
        self.layout.label(text=tree.title, icon="NODETREE")
        draw_entity(context, self.layout, tree.owner, tree.which)


def draw_header(self, context):
    """Title and choice of the graph, in the editor's header."""
    space = context.space_data
    if space.tree_type != entity_nodes.TREE:
        return
    obj = active_field(context)
    if obj is None:
        self.layout.label(text="Select a mesh with a Stormfield field", icon="INFO")
        return
    analysis = obj.stormfield.analysis
    if space.edit_tree is None:
        self.layout.label(text="No graph yet: Analyze at this Frame, in the Stormfield tab of the 3D view", icon="INFO")
        return
    row = self.layout.row(align=True)
    for which, icon in (("ecg", "FORCE_VORTEX"), ("mcg", "MOD_VERTEX_WEIGHT")):
        if getattr(analysis, f"{which}_tree") is not None:
            row.prop_enum(analysis, "shown", which, icon=icon)
    self.layout.label(text=summary(analysis.list(space.edit_tree.which)))


def summary(entities) -> str:
    """How many of a list are shown, at which λ, and how many are hidden."""
    count = sum(entities.passes(item) for item in entities.items)
    hidden = len(entities.items) - count
    more = f", {hidden} hidden" if hidden else ""
    return f"λ {entities.lam:.3f}: {count} shown{more}"


# Links ----------------------------------------------------------------------------------------------------------------


def _draw() -> None:
    context = bpy.context
    tree = context.space_data.edit_tree
    if context.space_data.tree_type != entity_nodes.TREE or tree is None or tree.bl_idname != entity_nodes.TREE:
        return
    draw_links(context, tree)
    shown = (tree.session_uid, len(tree.nodes))
    if _framed.get(context.area.as_pointer()) != shown:
        _framed[context.area.as_pointer()] = shown
        frame_soon()
    owner = tree.owner
    active = tree.nodes.active
    clicked = active is not None and active.select
    if owner is not None and clicked and active.entity != owner.stormfield.analysis.list(tree.which).active:
        _take_over(owner.session_uid, tree.which)


_framed: dict[int, tuple[int, int]] = {}  # per editor: the graph that was last brought into view, and its size


def frame_soon() -> None:
    """Bring the whole graph into view, in every editor that shows one, once it has been drawn."""

    def later():
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.ui_type == entity_nodes.TREE:
                    region = next(region for region in area.regions if region.type == "WINDOW")
                    with bpy.context.temp_override(window=window, area=area, region=region):
                        bpy.ops.node.view_all()

    bpy.app.timers.register(later, first_interval=0.1)


def _take_over(uid: int, which: str) -> None:
    """Drawing must not write; a timer does, right after it."""

    def later():
        obj = objects.find(uid)
        if obj is not None:
            selection.follow_graph(obj, which)

    bpy.app.timers.register(later, first_interval=0.0)


def _repair_soon(uid: int) -> None:
    """Right after Blender's own operator, which must not lose its nodes under its hands."""

    def later():
        for tree in bpy.data.node_groups:
            if tree.session_uid == uid and not entity_nodes.is_whole(tree):
                entity_nodes.make_whole(tree)

    bpy.app.timers.register(later, first_interval=0.0)


class STORMFIELD_OT_keep_entity(bpy.types.Operator):
    """Cancel what is selected in the graph, or say why that cannot be. A node alone is never deleted"""

    bl_idname = "stormfield.keep_entity"
    bl_label = "Cancel in Graph"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        space = context.space_data
        return space is not None and space.type == "NODE_EDITOR" and space.tree_type == entity_nodes.TREE

    def execute(self, context):
        tree, obj = context.space_data.edit_tree, active_field(context)
        if tree is None or obj is None or tree.which != "ecg" or tree.owner != obj:
            self.report({"WARNING"}, KEEPS)
            return {"CANCELLED"}
        reason = why_not_cancel(obj)
        if reason or not bpy.ops.stormfield.cancel_pair.poll():
            self.report({"WARNING"}, reason or KEEPS)
            return {"CANCELLED"}
        bpy.ops.stormfield.cancel_pair("INVOKE_DEFAULT")
        return {"FINISHED"}


#: What is said when an artist presses X in the graph.
KEEPS = (
    "The graph shows what the field does: nothing can be deleted in it. Cancel what the analysis at this frame shows, "
    "or change the elements and solve again"
)
_keys: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def _register_keys() -> None:
    """The keys that delete nodes cancel in our graphs, or say why not; in other node editors they do as ever."""
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:  # background mode
        return
    keys = config.keymaps.new(name="Node Editor", space_type="NODE_EDITOR")
    for key, modifiers in (("X", {}), ("DEL", {}), ("X", {"ctrl": True}), ("DEL", {"ctrl": True})):
        _keys.append((keys, keys.keymap_items.new(STORMFIELD_OT_keep_entity.bl_idname, key, "PRESS", **modifiers)))


def _unregister_keys() -> None:
    for keys, item in _keys:
        keys.keymap_items.remove(item)
    _keys.clear()


_kept: dict[int, tuple] = {}  # per tree: what its links were drawn from, and their batch


def draw_links(context: bpy.types.Context, tree: bpy.types.NodeTree) -> None:
    to_view, unit = context.region.view2d, context.preferences.system.ui_scale
    active = tree.nodes.active
    places = np.empty(2 * len(tree.nodes), np.float32)
    tree.nodes.foreach_get("location", places)
    selected = active.name if active is not None and active.select else ""
    key = (places.tobytes(), selected, len(tree.drawn), tree.owner and tree.owner.stormfield.analysis.version)
    shader = compat.builtin_shader("POLYLINE_SMOOTH_COLOR")
    if _kept.get(tree.session_uid, (None,))[0] != key:
        lines, colours = link_lines(tree)
        positions = np.c_[lines.reshape(-1, 2), np.zeros(2 * len(lines))].astype(np.float32)
        colours = colours.reshape(-1, 4).astype(np.float32)
        batch = batch_for_shader(shader, "LINES", {"pos": positions, "color": colours}) if len(lines) else None
        _kept[tree.session_uid] = (key, batch)
    batch = _kept[tree.session_uid][1]
    if batch is None:
        return
    corner, along = (np.array(to_view.view_to_region(x, x, clip=False)) for x in (0.0, 1e4))
    gpu.state.blend_set("ALPHA")
    with gpu.matrix.push_pop():
        gpu.matrix.translate(corner.tolist())
        gpu.matrix.scale(((along - corner) / 1e4 * unit).tolist())
        shader.bind()
        shader.uniform_float("viewportSize", (context.region.width, context.region.height))
        shader.uniform_float("lineWidth", 1.8 * unit)
        batch.draw(shader)
    gpu.state.blend_set("NONE")


def link_lines(tree: bpy.types.NodeTree) -> tuple[np.ndarray, np.ndarray]:
    """Segments of all links (l, 2, 2) in the tree's units, and their colours (l, 2, 4); arrow heads included."""
    nodes = tree.nodes
    active = nodes.active.name if nodes.active is not None and nodes.active.select else None
    where = {node.name: np.array((node.location[0] + 0.5 * node.width, node.location[1])) for node in nodes}
    tint: dict[str, np.ndarray] = {node.name: np.array(palette.kind_colour(node.kind)) for node in nodes}
    lines, colours = [], []
    for route in sorted(tree.drawn, key=lambda route: active in (route.source, route.target)):
        if route.source not in where or route.target not in where:
            continue  # the node was deleted
        points = _curve(
            where[route.source], where[route.target], np.array(route.bend) if route.bends else None, tree.row
        )
        blend = np.linspace(0.0, 1.0, len(points))[:, None]
        colour = tint[route.source] * (1 - blend) + tint[route.target] * blend
        shown = 1.0 if active in (route.source, route.target) else 0.35 if active else 0.65
        if shown == 1.0:
            colour = 0.35 + 0.65 * colour
        colour = np.c_[colour, np.full(len(points), shown)]
        lines.append(np.stack([points[:-1], points[1:]], axis=1))
        colours.append(np.stack([colour[:-1], colour[1:]], axis=1))
        head = _arrow(points)
        lines.append(head)
        colours.append(np.broadcast_to(colour[-1], (len(head), 2, 4)))
    if not lines:
        return np.zeros((0, 2, 2)), np.zeros((0, 2, 4))
    return np.concatenate(lines), np.concatenate(colours)


def _curve(start: np.ndarray, end: np.ndarray, bend: np.ndarray | None, row: float) -> np.ndarray:
    """From edge to edge of two nodes: leaves and arrives upright; within a row an arch above it."""
    t = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    half = np.array([0.0, 0.5 * NODE_HEIGHT])
    if abs(start[1] - end[1]) < NODE_HEIGHT:
        rise = min(0.3 * abs(end[0] - start[0]), 0.8 * row)
        top = np.array([0.5 * (start[0] + end[0]), max(start[1], end[1]) + rise])
        start, end = start + half, end + half
        return (1 - t) ** 2 * start + 2 * t * (1 - t) * top + t**2 * end
    sign = 1.0 if start[1] > end[1] else -1.0
    start, end = start - sign * half, end + sign * half
    if bend is None:
        return _upright(start, end, t)
    return np.concatenate([_upright(start, bend, t)[:-1], _upright(bend, end, t)])


def _upright(start: np.ndarray, end: np.ndarray, t: np.ndarray) -> np.ndarray:
    reach = np.array([0.0, 0.4 * (end[1] - start[1])])
    a, b = start + reach, end - reach
    return (1 - t) ** 3 * start + 3 * t * (1 - t) ** 2 * a + 3 * t**2 * (1 - t) * b + t**3 * end


def _arrow(points: np.ndarray) -> np.ndarray:
    """Two barbs at the end of a curve: (2, 2, 2)."""
    tip = points[-1]
    back = points[-2] - tip
    back *= 9.0 / max(float(np.linalg.norm(back)), 1e-9)
    aside = 0.45 * np.array([-back[1], back[0]])
    return np.array([[tip, tip + back + aside], [tip, tip + back - aside]])


CLASSES = (
    RouteItem,
    PlaceItem,
    StormfieldGraph,
    StormfieldEntity,
    STORMFIELD_OT_keep_entity,
    STORMFIELD_PT_graph_entity,
)


def register() -> None:
    global _handle
    bpy.types.NODE_HT_header.append(draw_header)
    _register_keys()
    if not bpy.app.background:
        _handle = bpy.types.SpaceNodeEditor.draw_handler_add(_draw, (), "WINDOW", "BACKDROP")


def unregister() -> None:
    global _handle
    if _handle is not None:
        bpy.types.SpaceNodeEditor.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _unregister_keys()
    _kept.clear()
    _framed.clear()
    bpy.types.NODE_HT_header.remove(draw_header)
