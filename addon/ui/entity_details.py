# SPDX-License-Identifier: GPL-3.0-or-later
"""The selected entity in words, below the list and in the graph editor."""

from ..scene.read.results import EVENT_KINDS
from . import icons, markers
from .panel_parts import text_lines


def draw_entity(context, layout, obj, which: str) -> None:
    """Name, kind and numbers of the selected entity of a list."""
    entities = obj.stormfield.analysis.list(which)
    item = entities.selected()
    if item is None:
        layout.label(text="Click an entity to see more", icon="RESTRICT_SELECT_OFF")
        return
    box = layout.box().column(align=True)
    kind = "" if item.kind in EVENT_KINDS else markers.NAMES.get(item.kind, item.kind.title())
    if item.storm:
        kind = "Storm" if item.kind == "center" else f"Storm, {kind.lower()}"
    box.label(text=f"{item.name}   {kind}", icon_value=icons.of(item.kind))
    for text in _facts(which, item):
        text_lines(context, box, text, icon="BLANK1")


def _facts(which: str, item) -> list[str]:
    facts = []
    if which == "history" and item.lam_end > item.lam_start:
        facts.append(f"λ {item.lam_start:.3f} to {item.lam_end:.3f}")
    elif which == "history" and item.kind in EVENT_KINDS:
        facts.append(f"at λ {item.lam:.4f}")
    if item.faces:
        facts.append(f"{item.faces} faces")
    if item.strength > 0 and which != "mcg":
        facts.append(f"strength {item.strength:.3g} per second")
    return [*facts, item.note] if item.note else facts
