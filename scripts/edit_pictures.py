# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of edits, docs/pictures/edits/*.png: fields before and after, as the thesis's figures 4.1 to 4.4 show them.

STORMFIELD_DATA=... .venv/bin/python scripts/edit_pictures.py [cases block smoothed simplified wind]

cases: one found pair for each of the thirteen cancellations. block: the faces that an edit may change. smoothed: six
regions of the gas engine, engine_smoothing.json. simplified: the gas engine with 12 entities. wind: that around a
hurricane with 60.
"""

from __future__ import annotations

import json
import os
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from stormfield import native
from stormfield.analysis.colours import KIND_COLOURS
from stormfield.edits import edit_steps
from stormfield.figures.surface_panel import SurfacePanel
from stormfield.figures.view import View, choose_views
from stormfield.model.edits import edits_from_json
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field
from stormfield.readers.icosphere import icosphere
from stormfield.work import run

TARGET = Path(__file__).parents[1] / "docs" / "pictures" / "edits"
REGIONS = Path(__file__).with_name("engine_smoothing.json")
#: Colour of a surface, and of the faces that an edit may change.
SURFACE, BLOCK = (0.97, 0.97, 0.97), (0.72, 0.9, 0.76)
SEPARATRICES = {2: KIND_COLOURS["sink"], 3: KIND_COLOURS["source"]}


@dataclass(frozen=True, eq=False)
class Flow:
    field: native.VectorField
    topology: native.Topology

    @staticmethod
    def of(field: native.VectorField) -> Flow:
        return Flow(field, native.topology(field))

    @property
    def count(self) -> int:
        return len(self.topology.fixed_points) + len(self.topology.periodic_orbits)


def draw(axis, flow: Flow, view: View, density: float, faces: np.ndarray | None = None, dots: float = 34.0) -> None:
    """Streamlines, separatrices, orbits and fixed points on the surface; faces: of a block."""
    mesh = flow.field.mesh
    panel = SurfacePanel(axis, mesh, view)
    colours = np.full((mesh.face_count, 3), SURFACE)
    if faces is not None:
        colours[np.asarray(faces, int)] = BLOCK
    panel.draw_surface(colours)
    lines = native.evenly_spaced_streamlines(flow.field, density * mesh.size, topology=True)
    panel.draw_streamlines(lines, "0.45", SEPARATRICES)
    for orbit in flow.topology.periodic_orbits:
        closed = np.concatenate([orbit.points, orbit.points[:1]])
        panel.draw_curves([closed], KIND_COLOURS[orbit.kind], 2.4)
    points = flow.topology.fixed_points
    if points:
        panel.draw_points(np.array([p.position for p in points]), [KIND_COLOURS[p.kind] for p in points], size=dots)


def save(figure: Figure, name: str, dpi: int = 110) -> None:
    TARGET.mkdir(parents=True, exist_ok=True)
    figure.savefig(TARGET / f"{name}.png", dpi=dpi, bbox_inches="tight")
    print(TARGET / f"{name}.png", flush=True)


def side_by_side(name: str, before: Flow, after: Flow, density: float, faces: np.ndarray | None = None, **look) -> None:
    view = choose_views(before.field.mesh)[0]
    wide = 2.0 if view.is_map else 1.0
    figure = Figure(figsize=(5.2 * wide, 11.0) if view.is_map else (11.0, 5.6), layout="constrained")
    axes = figure.subplots(2, 1) if view.is_map else figure.subplots(1, 2)
    for axis, flow, own in ((axes[0], before, faces), (axes[1], after, None)):
        draw(axis, flow, view, density, own, **look)
        axis.set_title(f"{flow.count} entities", fontsize=11)
    save(figure, name)


# The thirteen cancellations -------------------------------------------------------------------------------------------

#: Kinds of both (n a node, o an orbit, s a saddle), saddles between them, what must remain.
CASES = {
    "node and saddle": ("ns", 0, "nothing"),
    "node in an orbit": ("no", 0, "one node"),
    "two orbits": ("oo", 0, "nothing"),
    "orbit and saddle": ("os", 0, "one saddle"),
    "node and saddle, two links": ("ns", 0, "one orbit"),
    "orbit and saddle, two links": ("os", 0, "one orbit and one saddle"),
    "source, 2 saddles, sink": ("nn", 2, "nothing"),
    "source, saddle, sink": ("nn", 1, "one node"),
    "orbit, 2 saddles, node": ("no", 2, "one saddle"),
    "orbit, saddle, node": ("no", 1, "nothing"),
    "orbit, saddle, node, two to the orbit": ("no", 1, "one orbit"),
    "orbit, 2 saddles, orbit": ("oo", 2, "two saddles"),
    "orbit, saddle, orbit": ("oo", 1, "one saddle"),
}
#: When this many cases or fewer are missing, so many more fields are tried.
PATIENCE, MORE = 1, 40
LETTERS = {"source": "n", "sink": "n", "saddle": "s", "attracting": "o", "repelling": "o"}


def plain(left: str) -> str:
    for kind, word in (("source", "node"), ("sink", "node"), ("attracting ", ""), ("repelling ", "")):
        left = left.replace(kind, word)
    return left


def random_flows() -> Iterator[Flow]:
    """On the sphere, with orbits among them: smooth waves, turned a little."""
    sphere = icosphere(5120)
    mesh = native.TriangleMesh(sphere.vertices, sphere.triangles)
    for seed in range(400):
        random = np.random.default_rng(seed)
        waves = random.uniform(-2.5, 2.5, (2, 5, 3))
        vectors = np.sin(sphere.vertices @ waves[0].T) @ waves[1]
        values = np.asarray(native.VectorField.from_space(mesh, vectors).values)
        yield Flow.of(native.VectorField(mesh, values * np.exp(1j * random.uniform(0.9, 1.5))))


def kind_of(topology: native.Topology, entity: tuple[str, int]) -> str:
    found = topology.fixed_points if entity[0] == "fixed_point" else topology.periodic_orbits
    return found[entity[1]].kind


def find_cases() -> dict[str, tuple[Flow, Flow, np.ndarray]]:
    """A verified cancellation for each case: before, after, block."""
    found: dict[str, tuple[Flow, Flow, np.ndarray]] = {}
    tried = 0
    for flow in random_flows():
        if len(found) >= len(CASES) - PATIENCE:
            tried += 1
        if tried > MORE:
            break
        topology = flow.topology
        entities = [("fixed_point", k) for k in range(len(topology.fixed_points))]
        entities += [("periodic_orbit", k) for k in range(len(topology.periodic_orbits))]
        for number, a in enumerate(entities):
            for b in entities[number + 1 :]:
                letters = "".join(sorted(LETTERS.get(kind_of(topology, each), "x") for each in (a, b)))
                wanted = [name for name, case in CASES.items() if case[0] == letters and name not in found]
                if not wanted:
                    continue
                try:
                    plan = native.plan_cancel(flow.field, topology, a, b)
                except InputError:
                    continue
                name = next((n for n in wanted if CASES[n][1:] == (len(plan.saddles), plain(plan.left))), None)
                result = native.cancel_pair(flow.field, topology, a, b) if name else None
                if name and result is not None and result.applied:
                    found[name] = flow, Flow(result.field, result.topology), np.asarray(result.faces)
                    print(f"{len(found)} of {len(CASES)}: {name}", flush=True)
        if len(found) == len(CASES):
            break
    return found


def cases() -> None:
    found = find_cases()
    shown = [name for name in CASES if name in found]
    columns = 7
    rows = -(-len(shown) // columns)
    figure = Figure(figsize=(2.3 * columns, 5.0 * rows), layout="constrained")
    axes = figure.subplots(2 * rows, columns)
    for axis in axes.ravel():
        axis.set_axis_off()
    for place, name in enumerate(shown):
        before, after, faces = found[name]
        row, column = divmod(place, columns)
        view = facing(before.field.mesh, faces)
        for below, flow in enumerate((before, after)):
            axis = axes[2 * row + below, column]
            draw(axis, flow, view, 0.03, faces, dots=22.0)
            zoom(axis, before.field.mesh, faces)
            axis.set_title(name if below == 0 else f"leaves {CASES[name][2]}", fontsize=8)
    save(figure, "cases", dpi=95)
    missing = [name for name in CASES if name not in found]
    if missing:
        print("not found:", ", ".join(missing))


def facing(mesh: native.TriangleMesh, faces: np.ndarray) -> View:
    """Straight onto the block."""
    towards = np.asarray(mesh.face_normals)[faces].mean(axis=0)
    towards /= np.linalg.norm(towards)
    right = np.cross((0.0, 0.0, 1.0) if abs(towards[2]) < 0.9 else (0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    return View("", np.array([right, np.cross(towards, right), towards]))


def zoom(axis, mesh: native.TriangleMesh, faces: np.ndarray) -> None:
    """The block and as much around it."""
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)[faces].ravel()]
    middle = corners.mean(axis=0)
    reach = min(1.0, 1.6 * np.linalg.norm(corners - middle, axis=1).max())
    left, right = axis.get_xlim()
    bottom, top = axis.get_ylim()
    x, y = 0.5 * (left + right), 0.5 * (bottom + top)
    half = 0.5 * (right - left) * reach
    axis.set_xlim(x - half, x + half)
    axis.set_ylim(y - half, y + half)


# Gas engine and wind --------------------------------------------------------------------------------------------------


def engine() -> native.VectorField:
    data = read_field(Path(os.environ["STORMFIELD_DATA"]) / "gasEngineV.t")
    mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    return native.VectorField.from_space(mesh, np.asarray(data.vectors[0], np.float64))


def block() -> None:
    """The pair of the gas engine whose block is largest among the first that can be cancelled."""
    flow = Flow.of(engine())
    best = None
    for source, target in (link[:2] for link in flow.topology.links):
        try:
            result = native.cancel_pair(flow.field, flow.topology, source, target)
        except InputError:
            continue
        if result.applied and (best is None or len(result.faces) > len(best.faces)):
            best = result
    if best is not None:
        faces, after = np.asarray(best.faces), Flow(best.field, best.topology)
        figure = Figure(figsize=(9.0, 4.6), layout="constrained")
        view = facing(flow.field.mesh, faces)
        for axis, shown in zip(figure.subplots(1, 2), (flow, after), strict=True):
            draw(axis, shown, view, 0.012, faces)
            axis.set_title(f"{shown.count} entities", fontsize=10)
        save(figure, "block")


def smoothed() -> None:
    """Six regions that a user chose (thesis figure 4.4)."""
    field = engine()
    one = native.ParameterizedField(field.mesh, np.zeros(1), np.asarray(field.values)[None])
    edited = run(edit_steps(one, edits_from_json(json.loads(REGIONS.read_text()))))
    faces = np.unique(np.concatenate([report.samples[0].faces for report in edited.reports]))
    side_by_side("engine_smoothed", Flow.of(field), Flow.of(edited.field.sample(0)), 0.016, faces)


def simplified() -> None:
    flow = Flow.of(engine())
    result = native.simplify(flow.field, flow.topology, keep=12)
    side_by_side("engine_simplified", flow, Flow(result.field, result.topology), 0.016)


def wind() -> None:
    """Wind around the hurricane Michael: what is left of 343 entities."""
    choice = Choice(sphere_faces=8000)
    data = read_field(Path(os.environ["STORMFIELD_DATA"]) / "gfs_wind_michael_2018.npz", choice)
    unit = data.mesh.vertices / np.linalg.norm(data.mesh.vertices, axis=1, keepdims=True)  # which is drawn as a map
    mesh = native.TriangleMesh(unit, data.mesh.triangles)
    flow = Flow.of(native.VectorField.from_space(mesh, np.asarray(data.vectors[0], np.float64)))
    result = native.simplify(flow.field, flow.topology, keep=60)
    print(Counter(point.kind for point in result.topology.fixed_points), len(result.topology.periodic_orbits))
    side_by_side("wind", flow, Flow(result.field, result.topology), 0.013, dots=18.0)


if __name__ == "__main__":
    for name in sys.argv[1:] or ("cases", "block", "smoothed", "simplified", "wind"):
        {"cases": cases, "block": block, "smoothed": smoothed, "simplified": simplified, "wind": wind}[name]()
