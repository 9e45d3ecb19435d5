# SPDX-License-Identifier: GPL-3.0-or-later
"""What is picked for an edit, and why it cannot be edited: quick enough for panels and poll messages."""

import bpy

from ..scene.read.current_field import is_given, why_no_field
from ..scene.read.freshness import edits_digests
from ..session import edit_preview, freshness
from . import requirements, solve

#: λ that differ by less are the same.
SAME_LAMBDA = 1e-4


def why_not_field(obj: bpy.types.Object) -> str:
    """Why the field cannot be edited now, and the cure; empty when it can."""
    if is_given(obj):
        unapplied = "Apply Edits first: edits were changed" if edits_differ(obj) else ""
        return requirements.problem() or why_no_field(obj) or unapplied
    if not obj.stormfield.solve.solved and not why_no_field(obj):
        return "This field was not solved here: Solve first"
    stale = freshness.why_out_of_date(obj)
    return solve.why_not(obj) or why_no_field(obj) or (f"Solve first: {stale}" if stale else "")


def edits_differ(obj: bpy.types.Object) -> bool:
    """Whether the edits of a given field are others than those that were applied."""
    return edits_digests(obj) != [part for part in obj.stormfield.edited.split(",") if part]


def why_not_region(obj: bpy.types.Object) -> str:
    """The same for edits of a region, which may be selected in Edit Mode."""
    if obj.mode != "EDIT":
        return why_not_field(obj)
    return "" if obj.stormfield.solve.solved or is_given(obj) else "Solve first: there is no field on the mesh yet"


def why_not(obj: bpy.types.Object) -> str:
    """Why what the analysis shows cannot be edited now, and the cure; empty when it can."""
    field, reason = obj.stormfield, why_not_field(obj)
    ecg = field.analysis.ecg
    if reason:
        return reason
    if not ecg.made:
        return "Analyze at this Frame first: an edit changes what the analysis shows"
    if ecg.shown_field != field.look.shown_field or abs(ecg.lam - field.lam) > SAME_LAMBDA:
        return f"Analyze at this Frame again: the analysis is that of λ {ecg.lam:.3f}, or of the other field"
    return ""


def picked(obj: bpy.types.Object) -> tuple[int, ...]:
    """Places in the list of the entities that are selected: several in the graph, otherwise the one of the list."""
    ecg, tree = obj.stormfield.analysis.ecg, obj.stormfield.analysis.ecg_tree
    nodes = [node.entity for node in tree.nodes if node.select] if tree is not None else []
    if len(nodes) > 1:
        return tuple(sorted(set(nodes)))
    return (ecg.active,) if ecg.selected() is not None else ()


def why_not_cancel(obj: bpy.types.Object) -> str:
    """As why_not, and why what is picked cannot be cancelled."""
    reason = why_not(obj)
    if reason:
        return reason
    chosen = picked(obj)
    if not chosen:
        return "Select one entity in list, graph or view, or two with Shift in graph or view"
    if len(chosen) > 2:
        return f"{len(chosen)} entities are selected; select one, or the two that shall vanish together"
    items = [obj.stormfield.analysis.ecg.items[index] for index in chosen]
    center = next((item for item in items if item.kind in {"center", "degenerate"}), None)
    if center is not None:
        return f"{center.name} is a {center.kind}: what vanishes is a source, sink, saddle or periodic orbit"
    if len(items) == 2 and items[0].row == items[1].row != "saddle":
        return f"{items[0].name} and {items[1].name} both are {items[0].row}: no flow leads from one to the other"
    return _why_apart(obj.stormfield.analysis.ecg_tree, chosen) or _refused(obj, chosen)


def _refused(obj: bpy.types.Object, chosen: tuple[int, ...]) -> str:
    """What the core says against two that are selected, as far as a preview has asked it."""
    active = obj.stormfield.analysis.ecg.active
    if len(chosen) != 2 or active not in chosen or bpy.app.background:
        return ""
    partner = edit_preview.partners(obj).get(next(index for index in chosen if index != active))
    return "" if partner is None else partner.reason


def why_not_move(obj: bpy.types.Object) -> str:
    """As why_not, and why what is selected cannot be moved."""
    reason = why_not(obj)
    if reason:
        return reason
    item = obj.stormfield.analysis.ecg.selected()
    if item is None:
        return "Select a fixed point in list, graph or view"
    if item.kind not in {"source", "sink", "saddle", "center"}:
        return f"{item.name} is no source, sink, saddle or center: those can be moved"
    return ""


def _why_apart(tree: bpy.types.NodeTree | None, chosen: tuple[int, ...]) -> str:
    """Why no flow joins what is picked; empty where some does, and where the graph was deleted."""
    if tree is None:
        return ""
    names = [tree.places[index].name for index in chosen]
    follows: dict[str, set[str]] = {}
    for route in tree.routes:
        follows.setdefault(route.source, set()).add(route.target)
    if len(names) == 1:
        linked = set(follows).union(*follows.values())
        return "" if names[0] in linked else f"No flow joins {names[0]} with another entity"
    first, second = names
    if second in _reached(follows, first) or first in _reached(follows, second):
        return ""
    return f"No flow leads from {first} to {second} or back: select two that lines of the graph join"


def _reached(follows: dict[str, set[str]], start: str) -> set[str]:
    """All that flow from an entity comes to."""
    found: set[str] = set()
    ahead = [start]
    while ahead:
        new = follows.get(ahead.pop(), set()) - found
        found |= new
        ahead += new
    return found
