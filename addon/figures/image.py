# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of an analysis for papers and reports: `--image OUT.png` of analyze, morse and track.

Left the surface with its field as evenly spaced streamlines and the entities in the thesis's colours (closed surfaces
from two opposite sides, flat ones from above, winds on a sphere as a map), right the graph in its three rows.
The format follows the ending of the path (png, pdf, svg). Everything raises InputError when matplotlib is missing, the
ending is unknown or the file cannot be written.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import native
from ..analysis.colours import KIND_COLOURS
from ..analysis.entities import EntityGraph
from ..analysis.layout import layout
from ..analysis.tracking import Tracking
from ..model.errors import InputError
from .surface_panel import SurfacePanel
from .view import choose_views

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Distance between streamlines, over the surface's size, and on a map, which is larger.
DENSITY, MAP_DENSITY = 0.022, 0.013
#: Inches of one view, and of the graph.
VIEW, GRAPH = 6.0, 5.5
DPI = 180
#: Largest number of entities whose names are written into graphs, and onto surfaces.
MAX_NAMES, MAX_LABELS = 60, 40
#: Links with arrow heads at most; all flow downwards, except for arches.
MAX_HEADS = 200
#: Brightness of a surface seen face on.
SURFACE = 0.97
#: How strongly Morse sets are coloured, so that the flow on them is seen.
PALE = 0.7
#: Roles of streamlines and their colours: separatrices that leave saddles as what attracts, those that enter as what
#: repels (thesis 3.4).
SEPARATRICES = {2: KIND_COLOURS["sink"], 3: KIND_COLOURS["source"]}
#: Fixed points in the order of the legend, and what the legend calls Morse sets.
POINTS = ("source", "sink", "saddle", "center", "degenerate")
SETS = {"source": "repelling set", "sink": "attracting set", "saddle": "saddle-like set", "trivial": "trivial set"}


def draw_analysis(path: str | Path, mesh: native.TriangleMesh, vectors: np.ndarray, graph: EntityGraph) -> None:
    """The field with its fixed points, periodic orbits and separatrices, next to the entity connection graph.

    vectors: (n, 3) at its vertices, mesh units per second. graph: of the same field.
    """
    check(path)
    panels, figure, axis = _page(mesh, graph)
    lines = _streamlines(mesh, vectors, topology=True)
    for panel in panels:
        panel.draw_surface(np.full((mesh.face_count, 3), SURFACE))
        panel.draw_streamlines(lines, "0.4", SEPARATRICES)
        for entity in graph.entities:
            if entity.curve is not None:
                panel.draw_curves([entity.curve], KIND_COLOURS[entity.kind], 2.4)
        points = [entity for entity in graph.entities if entity.curve is None]
        panel.draw_points(np.array([e.position for e in points]), [KIND_COLOURS[e.kind] for e in points])
        if len(graph.entities) <= MAX_LABELS:
            panel.draw_labels(np.array([e.position for e in graph.entities]), [e.name for e in graph.entities])
    _draw_graph(axis, graph)
    _legend(figure, graph, lines=bool(np.isin(lines.roles, list(SEPARATRICES)).any()))
    _save(figure, path)


def draw_morse(
    path: str | Path, mesh: native.TriangleMesh, vectors: np.ndarray, graph: EntityGraph, face_sets: np.ndarray
) -> None:
    """The field with its Morse sets as coloured faces, next to the Morse connection graph.

    face_sets: (m,) int32, per face the Morse set it belongs to (id in graph.entities), -1 for none.
    """
    check(path)
    panels, figure, axis = _page(mesh, graph)
    lines = _streamlines(mesh, vectors, topology=False)
    colours = np.full((mesh.face_count, 3), SURFACE)
    table = np.array([_pale(entity.kind) for entity in graph.entities]).reshape(-1, 3)
    inside = np.asarray(face_sets) >= 0
    colours[inside] = table[np.asarray(face_sets)[inside]]
    for panel in panels:
        panel.draw_surface(colours)
        panel.draw_streamlines(lines, "0.25")
        places = [entity for entity in graph.entities if entity.faces is not None]
        panel.draw_points(np.array([e.position for e in places]), [KIND_COLOURS[e.kind] for e in places], size=12.0)
        if len(graph.entities) <= MAX_LABELS:
            panel.draw_labels(np.array([e.position for e in graph.entities]), [e.name for e in graph.entities])
    _draw_graph(axis, graph)
    _legend(figure, graph, sets=True)
    _save(figure, path)


def draw_tracking(path: str | Path, mesh: native.TriangleMesh, tracking: Tracking) -> None:
    """The paths of the fixed points over λ, coloured by λ, with bifurcations, next to their life spans.

    tracking: best filtered by persistence.
    """
    check(path)
    panels, figure, axis = _page(mesh, None)
    import matplotlib

    colour_of = matplotlib.colormaps["viridis"]
    for panel in panels:
        panel.draw_surface(np.full((mesh.face_count, 3), SURFACE))
        for track in tracking.paths:
            panel.draw_coloured_path(track.positions, track.lambdas, colour_of)
        events = [event for event in tracking.bifurcations if event.kind != "hopf"]
        panel.draw_points(np.array([e.position for e in events]), [(1.0, 1.0, 1.0)] * len(events), size=22.0)
        ends = [track for track in tracking.paths if track.end in ("last", "boundary")]
        panel.draw_points(np.array([t.positions[-1] for t in ends]), [KIND_COLOURS[t.kind] for t in ends], size=22.0)
        if len(tracking.paths) <= MAX_LABELS:
            middles = np.array([track.positions[len(track.positions) // 2] for track in tracking.paths])
            panel.draw_labels(middles, [track.name for track in tracking.paths])
    _draw_lives(axis, tracking)
    bar = figure.colorbar(
        matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(0.0, 1.0), colour_of),
        ax=[panel.axis for panel in panels], orientation="horizontal", fraction=0.035, pad=0.02, aspect=50,
    )  # fmt: skip
    bar.set_label("λ")
    _track_legend(figure, tracking)
    _save(figure, path)


def check(path: str | Path) -> None:
    """Raises InputError when nothing could be drawn: call it before the long work."""
    try:
        import matplotlib
        import matplotlib.figure
    except ImportError:
        raise InputError(
            "pictures are drawn by matplotlib, which is missing: install it (pip install 'stormfield[image]')"
        ) from None
    known = sorted(matplotlib.figure.Figure().canvas.get_supported_filetypes())
    if Path(path).suffix.lower().lstrip(".") not in known:
        raise InputError(f"{path}: no picture has this ending; choose one of {', '.join(known)}")
    if not Path(path).resolve().parent.is_dir():
        raise InputError(f"{path}: the folder is missing; make it first")


def _page(mesh: native.TriangleMesh, graph: EntityGraph | None) -> tuple[list[SurfacePanel], Figure, Axes]:
    """One panel per view and an axis for the graph, wide enough for its longest row."""
    from matplotlib.figure import Figure

    views = choose_views(mesh)
    widths = [1.8 * VIEW if view.is_map else VIEW for view in views]
    entities = len(graph.entities) if graph is not None else 0
    graph_width = GRAPH + 0.07 * min(60, max(0, entities - 20))
    figure = Figure(figsize=(sum(widths) + graph_width, VIEW + 0.5), dpi=DPI, layout="constrained")
    axes = figure.subplots(1, len(views) + 1, width_ratios=[*widths, graph_width])
    panels = [SurfacePanel(axis, mesh, view) for axis, view in zip(axes, views, strict=False)]
    return panels, figure, axes[-1]


def _streamlines(mesh: native.TriangleMesh, vectors: np.ndarray, topology: bool) -> native.EvenStreamlines:
    field = native.VectorField.from_space(mesh, np.ascontiguousarray(vectors, np.float64))
    density = MAP_DENSITY if choose_views(mesh)[0].is_map else DENSITY
    return native.evenly_spaced_streamlines(field, density * mesh.size, topology=topology)


def _pale(kind: str) -> np.ndarray:
    return (1.0 - PALE) + PALE * np.array(KIND_COLOURS[kind])


def _draw_graph(axis: Axes, graph: EntityGraph) -> None:
    axis.set_axis_off()
    axis.set_title(graph.title, fontsize=11)
    if not graph.entities:
        axis.text(0.5, 0.5, "no entities", ha="center", va="center", color="0.5", transform=axis.transAxes)
        return
    try:
        drawn = layout(graph)
    except ImportError as fault:
        raise InputError(str(fault)) from None
    many = len(graph.entities) > MAX_NAMES
    # Marks shrink with the width of the graph; the rows keep their distance.
    wide = max(drawn.width, 4.0)
    size = float(np.clip(9000.0 / (wide + 4.0) ** 1.35, 10.0, 420.0))
    head_size = 6.0 if many else 11.0
    line = float(np.clip(60.0 / max(1, len(graph.links)), 0.25, 0.9))
    for link, route in zip(graph.links, drawn.routes, strict=True):
        leaves = graph.entities[link.source].row != "repelling"
        colour = KIND_COLOURS["sink" if leaves else "source"]
        curve = _bent(route)
        axis.plot(*curve.T, color=colour, alpha=0.7, linewidth=line, zorder=1)
        if len(graph.links) > MAX_HEADS:
            continue
        head = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "lw": 0, "mutation_scale": head_size}
        middle = len(curve) // 2
        axis.annotate("", curve[middle + 1], curve[middle], arrowprops=head, zorder=1)
    for entity, place in zip(graph.entities, drawn.positions, strict=True):
        closed = entity.curve is not None
        axis.scatter(
            *place, s=size, marker="o", facecolors="white" if closed else [KIND_COLOURS[entity.kind]],
            edgecolors=[KIND_COLOURS[entity.kind]] if closed else "white", linewidths=2.0 if closed else 0.8, zorder=2,
        )  # fmt: skip
        if not many and size > 90.0:
            axis.text(
                *place, entity.name, ha="center", va="center", zorder=3, color="0.1" if closed else "white",
                fontsize=float(np.clip(0.4 * np.sqrt(size), 4.0, 8.0)), fontweight="bold",
            )  # fmt: skip
    axis.set_xlim(-0.5 * wide - 0.7, 0.5 * wide + 0.7)
    axis.set_ylim(-0.5, 2.5)


def _bent(route: np.ndarray, pieces: int = 24) -> np.ndarray:
    """The route as a smooth curve: a parabola through its bend, where it has one."""
    t = np.linspace(0.0, 1.0, pieces + 1)[:, None]
    start, end = route[0], route[-1]
    control = 2.0 * route[1] - 0.5 * (start + end) if len(route) == 3 else 0.5 * (start + end)
    return (1.0 - t) ** 2 * start + 2.0 * t * (1.0 - t) * control + t**2 * end


def _draw_lives(axis: Axes, tracking: Tracking) -> None:
    """One bar per path from where it begins to where it ends, with its bifurcations."""
    axis.set_title("Life spans", fontsize=11)
    order = sorted(tracking.paths, key=lambda track: (track.first, -track.life))
    row = {track.id: i for i, track in enumerate(order)}
    width = float(np.clip(150.0 / max(1, len(order)), 0.4, 2.0))
    for track in order:
        axis.hlines(row[track.id], track.first, track.last, colors=[KIND_COLOURS[track.kind]], linewidth=width)
        if len(order) <= MAX_NAMES:
            axis.text(track.first - 0.008, row[track.id], track.name, ha="right", va="center", fontsize=6, color="0.3")
    for event in tracking.bifurcations:
        rows = [row[path] for path in event.paths if path in row]
        axis.vlines(event.lam, min(rows), max(rows), colors="0.75", linewidth=0.7, zorder=0)
        axis.plot(
            [event.lam] * len(rows), rows, "o", markersize=1.0 + width, color="0.15", markerfacecolor="white", mew=0.5
        )
    axis.set_xlim(-0.08, 1.02)
    axis.set_ylim(len(order) - 0.3, -0.7)
    axis.set_xlabel("λ")
    axis.set_yticks([])
    for side in ("left", "right", "top"):
        axis.spines[side].set_visible(False)


def _legend(figure: Figure, graph: EntityGraph, lines: bool = False, sets: bool = False) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    kinds = {entity.kind for entity in graph.entities}
    closed = {entity.kind for entity in graph.entities if entity.curve is not None}
    handles: list[Artist] = []

    def add_curve(kind: str, label: str, width: float) -> None:
        handles.append(Line2D([], [], color=KIND_COLOURS[kind], linewidth=width, label=label))

    if sets:
        # Kinds of one colour share a label: sources and repelling orbits are both repelling sets.
        named = {SETS.get(kind, f"{kind} set"): kind for kind in KIND_COLOURS if kind in kinds}
        handles += [Patch(color=_pale(kind), label=label) for label, kind in named.items()]
    else:
        for kind in POINTS:
            if any(entity.kind == kind and entity.curve is None for entity in graph.entities):
                dot = {"marker": "o", "linestyle": "", "markersize": 7.0, "markeredgecolor": "white"}
                handles.append(Line2D([], [], color=KIND_COLOURS[kind], label=kind, **dot))
        for kind in [kind for kind in KIND_COLOURS if kind in closed]:
            add_curve(kind, "closed orbits" if kind == "center" else f"{kind} orbit", 2.6)
    if lines:
        add_curve("sink", "outgoing separatrix", 1.3)
        add_curve("source", "incoming separatrix", 1.3)
    if handles:
        figure.legend(
            handles=handles, loc="outside lower center", ncols=min(len(handles), 8), frameon=False, fontsize=9
        )


def _track_legend(figure: Figure, tracking: Tracking) -> None:
    from matplotlib.lines import Line2D

    dot: dict[str, str | float] = {"marker": "o", "linestyle": "", "markersize": 6.0}
    kinds = {track.kind for track in tracking.paths}
    handles = [
        Line2D([], [], color=KIND_COLOURS[kind], markeredgecolor="white", label=f"{kind} at the end", **dot)
        for kind in POINTS
        if kind in kinds
    ]
    if any(event.kind != "hopf" for event in tracking.bifurcations):
        handles.append(Line2D([], [], color="white", markeredgecolor="0.15", label="appears or vanishes", **dot))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=9)


def _save(figure: Figure, path: str | Path) -> None:
    """Whole or not at all."""
    path = Path(path)
    temporary = path.with_name(f".{path.name}.tmp{path.suffix}")
    try:
        figure.savefig(temporary)
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another place") from error


__all__: Sequence[str] = ("check", "draw_analysis", "draw_morse", "draw_tracking")
