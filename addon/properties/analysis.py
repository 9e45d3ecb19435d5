# SPDX-License-Identifier: GPL-3.0-or-later
"""What an analysis found, saved with the object: entities of the current graphs, paths and bifurcations over λ.

The curves and points themselves live in the objects of the collection '<object> analysis'
(scene/write/analysis_objects.py); here is what lists, graphs and the overlay need to name, filter and select them.
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..analysis.quiet import ALWAYS
from ..scene.write import selection, timeline
from .overridable import overridable

#: The three lists, in the order of their tabs: (identifier, label, tooltip, icon, number).
LISTS = (
    (
        "ecg",
        "Now",
        "Fixed points, periodic orbits and their links at one λ: the entity connection graph (ECG)",
        "NONE",
        0,
    ),
    ("history", "Over Time", "Singularity paths of the fixed points over λ, and their bifurcations", "NONE", 1),
    (
        "mcg",
        "Regions",
        "Regions that hold all that comes back to where it was (Morse sets), and their order: the Morse connection "
        "graph (MCG)",
        "NONE",
        2,
    ),
)
#: Groups of the kind filter; every kind belongs to one of them.
CATEGORIES = (
    ("REPELLING", "Sources", "Sources and orbits that repel: green, dashed lines", "NONE", 1),
    ("SADDLE", "Saddles", "Saddles: blue", "NONE", 2),
    ("ATTRACTING", "Sinks", "Sinks and orbits that attract: orange, or red in the classic colours", "NONE", 4),
    ("OTHER", "Others", "Centers, degenerate and trivial ones", "NONE", 8),
    ("EVENT", "Events", "Where fixed points appear or vanish (bifurcations)", "NONE", 16),
    (
        "CHANGE",
        "Changes",
        "Where a source becomes a sink or back (Hopf bifurcations): often, along the path of a vortex",
        "NONE",
        32,
    ),
)
_CATEGORY = {"source": "REPELLING", "repelling": "REPELLING", "saddle": "SADDLE", "sink": "ATTRACTING"}
_CATEGORY |= {"attracting": "ATTRACTING", "creation": "EVENT", "annihilation": "EVENT", "hopf": "CHANGE"}


def category(kind: str) -> str:
    return _CATEGORY.get(kind, "OTHER")


def _selected(self, _context) -> None:
    selection.list_changed(self.id_data, self.path_from_id().rsplit(".", 1)[1])


def _filtered(self, _context) -> None:
    if self.path_from_id().endswith("history"):
        timeline.filter_markers(self.id_data)
    selection.filters_changed(self.id_data)


def _detail_changed(self, _context) -> None:
    if self.history.made:
        timeline.update_markers(self.id_data)
    selection.filters_changed(self.id_data)


@overridable
class EntityItem(bpy.types.PropertyGroup):
    """One entity; its place in the list is its id."""

    name: StringProperty(name="Name", description="Short and unique")
    kind: StringProperty(name="Kind", description="source, sink, saddle, attracting, creation, ...")
    row: StringProperty(name="Row", description="Row of the graph; of a bifurcation, the kind that meets the saddle")
    note: StringProperty(name="Note", description="Further numbers, in words")
    position: FloatVectorProperty(name="Position", description="In object space (mesh units)")
    strength: FloatProperty(name="Strength", description="Rate at which the flow leaves or approaches it (1/s)")
    lam: FloatProperty(name="λ", description="λ where a bifurcation happens (0..1)")
    life: FloatProperty(
        name="Life Span", description="Fraction of λ it lives through; of a bifurcation, its path (0..1)"
    )
    lam_start: FloatProperty(name="λ Start", description="λ where it appears (0..1)")
    lam_end: FloatProperty(name="λ End", description="λ where it vanishes (0..1)")
    faces: IntProperty(name="Faces", description="Faces of a Morse set (count)")
    weight: FloatProperty(
        name="Weight", description="How far it stands above the accuracy of a solve (factor)", default=ALWAYS
    )
    storm: BoolProperty(name="Storm", description="Whether the flow turns around it")
    words: StringProperty(name="Words", description="Of a bifurcation: what an artist calls it, as λ grows")


@overridable
class EntityList(bpy.types.PropertyGroup):
    items: CollectionProperty(type=EntityItem, name="Entities", description="In the order of the graph")
    active: IntProperty(name="Selected", description="The entity that list, graph and view show", update=_selected)
    made: BoolProperty(name="Made", description="Whether this analysis was made")
    serial: IntProperty(name="Serial", description="Which work made it, to know it again after undo")
    lam: FloatProperty(name="λ", description="λ that was analyzed (0..1)")
    shown_field: StringProperty(name="Field", description="Attribute that was analyzed")
    strongest: FloatProperty(name="Strongest", description="Greatest strength in the list (1/s)")
    kinds: EnumProperty(
        name="Kinds",
        description="Kinds that list and view show; Shift-click for several",
        items=CATEGORIES,
        options={"ENUM_FLAG"},
        default={key for key, *_ in CATEGORIES} - {"CHANGE"},
        update=_filtered,
    )
    min_strength: FloatProperty(
        name="Strength",
        description="Hide what is weaker than this fraction of the strongest (factor 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.0,
        update=_filtered,
    )
    min_life: FloatProperty(
        name="Life Span",
        description="Hide fixed points that live through less of λ than this fraction, and their bifurcations (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=3,
        update=_filtered,
    )

    def selected(self) -> EntityItem | None:
        return self.items[self.active] if 0 <= self.active < len(self.items) else None

    def passes(self, item: EntityItem) -> bool:
        """Whether the filters and Detail let it through."""
        return self.passes_filters(item) and item.weight >= self.id_data.stormfield.analysis.least_weight

    def passes_filters(self, item: EntityItem) -> bool:
        """Whether the filters let it through, however weak it is."""
        if category(item.kind) not in self.kinds:
            return False
        if self.min_strength > 0 and item.strength < self.min_strength * self.strongest:
            return False
        return item.life >= self.min_life

    def weak(self) -> int:
        """How many the filters let through and Detail hides."""
        return sum(self.passes_filters(item) and not self.passes(item) for item in self.items)


@overridable
class AnalysisProperties(bpy.types.PropertyGroup):
    ecg: PointerProperty(type=EntityList, name="Now", description="Entities of one λ")
    history: PointerProperty(type=EntityList, name="Over Time", description="Paths and bifurcations")
    mcg: PointerProperty(type=EntityList, name="Regions", description="Morse sets of one λ")
    shown: EnumProperty(name="Analysis", description="Which analysis is listed and edited", items=LISTS)
    version: IntProperty(name="Version", description="Counts analyses, so that drawings know what is new")
    collection: PointerProperty(type=bpy.types.Collection, name="Results", description="Objects of the analysis")
    ecg_tree: PointerProperty(type=bpy.types.NodeTree, name="ECG", description="Entity connection graph")
    mcg_tree: PointerProperty(type=bpy.types.NodeTree, name="MCG", description="Morse connection graph")
    markers: StringProperty(name="Markers", description="Timeline markers that belong to this analysis")
    passages: StringProperty(name="Passages", description="Frames at which λ passes each bifurcation")
    persistence: FloatProperty(
        name="Shortest Life",
        description="Follow over Time takes out paths that live through less of λ than this fraction: pairs that "
        "appear and vanish together go, paths with a short break become one (persistence, 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.0,
        precision=3,
    )
    detail: FloatProperty(
        name="Detail",
        description="Hides what may come from the accuracy of the solve and not from the design: at 0.5 what is weaker "
        "than it, below only what is far stronger stays, at 1 everything shows (0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.5,
        update=_detail_changed,
    )
    show: BoolProperty(name="Analysis", description="Draw the analysis in the 3D view", default=True)
    show_separatrices: BoolProperty(
        name="Dividing Lines",
        description="Curves that leave and enter the saddles (separatrices), at the λ analyzed",
        default=True,
    )
    show_orbits: BoolProperty(
        name="Orbits", description="Closed streamlines (periodic orbits), at the λ analyzed", default=True
    )
    show_paths: BoolProperty(
        name="Paths over Time",
        description="Paths of the fixed points over λ (singularity paths), dark at λ 0 and bright at 1",
        default=True,
    )
    show_sets: BoolProperty(name="Regions", description="Colour the faces of the regions (Morse sets)", default=True)
    show_partners: BoolProperty(
        name="Show Partners",
        description="Light up what the selected entity can be cancelled with, and grey what it cannot; two that are "
        "selected show the faces that would change",
        default=True,
    )
    preview_simplify: BoolProperty(
        name="Preview", description="Cross out at once what Simplify would take away", default=False
    )
    keep: IntProperty(
        name="Keep", description="Fixed points and orbits that Simplify leaves (count)", min=1, soft_max=100, default=12
    )
    show_names: BoolProperty(name="Names", description="Write the names of all entities next to them", default=False)
    width: FloatProperty(
        name="Line Width",
        description="Width of separatrices; orbits and paths are a little wider (pixels at 100 % interface scale)",
        min=0.5,
        max=10.0,
        default=2.0,
    )
    opacity: FloatProperty(
        name="Region Opacity",
        description="Opacity of the faces of regions (Morse sets, factor 0..1)",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        default=0.55,
    )

    @property
    def least_weight(self) -> float:
        """What weighs less is hidden: a factor of 100 for each half of the slider."""
        return 0.0 if self.detail >= 1.0 else 10.0 ** (4.0 * (0.5 - self.detail))

    def list(self, which: str) -> EntityList:
        return getattr(self, which)


CLASSES = (EntityItem, EntityList, AnalysisProperties)
