# SPDX-License-Identifier: GPL-3.0-or-later
"""Orbits, bifurcations, brush strokes and changing numbers from JSON to the solved field, as the command line goes."""

import json
from dataclasses import replace

import numpy as np
import pytest
from stormfield import native
from stormfield.cli import main
from stormfield.model.design import Design
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.solve import solve
from test_solve import sphere

MESH = sphere(4)


def design(*elements, samples=21):
    return Design.from_json(
        {"schema": "stormfield.design/2", "settings": {"samples": samples}, "elements": list(elements)}
    )


def circle(latitude, count=40):
    angles = np.arange(count) * 2.0 * np.pi / count
    high = np.sin(latitude) * np.ones(count)
    return np.stack([np.cos(latitude) * np.cos(angles), np.cos(latitude) * np.sin(angles), high], axis=1).tolist()


ORBIT = {"name": "ring", "type": "orbit", "kind": "attracting", "points": circle(0.2), "radius": 0.2}
EVENT = {
    "name": "pair",
    "type": "bifurcation",
    "kind": "appear_sink",
    "points": [[0, 0, 1]],
    "lam": [0.5],
    "direction": [1, 0, 0],
    "radius": 0.7,
    "reach": 0.3,
}
BRUSH = {"name": "comb", "type": "brush", "mode": "add", "points": circle(-0.9)[:15], "radius": 0.2}


def test_the_orbit_is_there():
    field = solve(MESH, design(ORBIT, samples=2)).fields["advection"]
    (orbit,) = native.topology(field.sample(0)).periodic_orbits
    assert orbit.kind == "attracting" and orbit.multiplier < 1.0


def test_the_pair_appears():
    field = solve(MESH, design(EVENT)).fields["advection"]
    events = [e for e in native.tracking(field).bifurcations if np.linalg.norm(np.array(e.position) - (0, 0, 1)) < 0.5]
    assert [e.kind for e in events] == ["creation"]
    assert events[0].lam == pytest.approx(0.5, abs=0.025)


def test_a_brush_changes_its_strip_alone():
    before = solve(MESH, design(ORBIT)).fields["advection"].values
    after = solve(MESH, design(ORBIT, BRUSH)).fields["advection"].values
    changed = np.any(before != after, axis=0)
    heights = MESH.vertices[:, 2]
    assert changed.any() and np.all(np.abs(np.arcsin(np.clip(heights[changed], -1, 1)) + 0.9) < 0.22)


def test_a_field_with_strokes_alone_is_the_other_one_with_them():
    solution = solve(MESH, design(ORBIT, {**BRUSH, "field": "orientation"}))
    fields = solution.fields
    assert np.any(fields["orientation"].values != fields["advection"].values)
    with pytest.raises(InputError, match="only brush strokes"):
        solve(MESH, design(BRUSH))


def test_nothing_crosses_a_border_that_is_a_wall():
    axis = np.linspace(-1.0, 1.0, 21)
    places = np.stack([*np.meshgrid(axis, axis), np.zeros((21, 21))], axis=-1).reshape(-1, 3)
    corners = np.arange(20 * 21).reshape(20, 21)[:, :-1].ravel()
    quads = np.stack([corners, corners + 1, corners + 22, corners + 21], axis=1)
    mesh = MeshData(places, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    river = {"name": "river", "type": "streamline", "points": [[-0.5, 0, 0], [0.5, 0.2, 0]], "radius": 0.2}
    crossing = {}
    for border in ("open", "wall"):
        plain = design(river, samples=2)
        solution = solve(mesh, replace(plain, settings=replace(plain.settings, border=border)))
        vectors = solution.fields["advection"].sample(0).to_space()
        right = (places[:, 0] == 1.0) & (np.abs(places[:, 1]) < 1.0)
        crossing[border] = np.abs(vectors[right, 0]).max()
    assert crossing["wall"] < 1e-9 < 0.05 < crossing["open"]


@pytest.mark.parametrize(
    ("element", "said"),
    [
        ({**ORBIT, "points": circle(1.565)}, 'orbit "ring" is .* across, smaller than an edge of the mesh'),
        ({**ORBIT, "points": (1.5 * np.array(circle(0.2))).tolist()}, 'orbit "ring" point 0 lies .* off the surface'),
        ({**EVENT, "lam": [0.99]}, "less than one sample from the end of the range"),
        ({**BRUSH, "radius": 1e-4}, "only brush strokes|off the surface"),
    ],
)
def test_faults_name_the_element(element, said):
    with pytest.raises(InputError, match=said):
        solve(MESH, design(element))


def test_the_command_line_solves_them(tmp_path, capsys):
    mesh = {"vertices": MESH.vertices.tolist(), "triangles": MESH.triangles.tolist()}
    storm = {
        "name": "gust",
        "type": "singular",
        "kind": "vortex_cw",
        "points": [[0, 0, -1]],
        "lam": [0, 0.3, 1],
        "strength": [0, 0.3, 0],
        "radius": 0.3,
    }
    path = tmp_path / "design.json"
    path.write_text(json.dumps(design(ORBIT, EVENT, BRUSH, storm, samples=9).to_json(mesh)), encoding="utf-8")
    assert main(["solve", str(path), "--out", str(tmp_path / "cache")]) == 0
    path.write_text(json.dumps(design({**ORBIT, "points": circle(1.565)}, samples=9).to_json(mesh)), encoding="utf-8")
    assert main(["solve", str(path), "--out", str(tmp_path / "other")]) == 2
    assert "smaller than an edge" in capsys.readouterr().err
