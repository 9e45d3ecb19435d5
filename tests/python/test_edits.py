# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits: the data, what they do to a field over λ, the command, and the edits of a design."""

import json

import meshio
import numpy as np
import pytest
from command_line import refused, run
from stormfield import native
from stormfield.cache.field_cache import open_cache
from stormfield.edits import edit_steps, notes_of
from stormfield.model.design import Design
from stormfield.model.edits import edits_from_json
from stormfield.model.errors import InputError
from stormfield.readers.icosphere import icosphere
from stormfield.work import run as finish


def edits(*given):
    return edits_from_json({"schema": "stormfield.edits/1", "edits": list(given)})


def plane(cells=40):
    """A square of vertices and triangles."""
    axis = np.linspace(-1.0, 1.0, cells + 1)
    x, y = np.meshgrid(axis, axis)
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i, j = np.divmod(np.arange(cells * cells), cells)
    a = i * (cells + 1) + j
    first, second = (a, a + 1, a + cells + 2), (a, a + cells + 2, a + cells + 1)
    triangles = np.concatenate([np.column_stack(first), np.column_stack(second)]).astype(np.int32)
    return vertices, triangles


def fold(vertices):
    """A sink at x = 0.3 and a saddle at x = -0.3."""
    x, y = vertices[:, 0] - 0.013, vertices[:, 1] - 0.007
    return np.column_stack([0.09 - x * x, -y, np.zeros(len(x))])


SINK = {"kind": "sink", "at": [0.31, 0, 0]}
SADDLE = {"kind": "saddle", "at": [-0.29, 0, 0]}
CANCEL = {"type": "cancel", "entities": [SINK, SADDLE]}


@pytest.fixture(scope="module")
def surface():
    return native.TriangleMesh(*plane())


def over_lambda(surface, samples=5):
    values = native.VectorField.from_space(surface, fold(surface.vertices)).values
    return native.ParameterizedField(surface, np.linspace(0.0, 1.0, samples), np.tile(values, (samples, 1)))


@pytest.mark.parametrize(
    ("edit", "fault"),
    [
        ({"type": "cancel"}, "edit 1: cancel needs entities: add it"),
        ({"type": "cancel", "entities": [SINK]}, "has 1 values: give at least 2"),
        ({"type": "cancel", "entities": [SINK, SINK]}, "the sink is given twice"),
        ({"type": "cancel", "entities": [SINK, {"kind": "whirl", "at": [0, 0, 0]}]}, 'is "whirl": use one of source'),
        ({**CANCEL, "lam": [0.0, 1.0]}, "cancel acts at one λ"),
        ({**CANCEL, "keep": 3}, "keep does not belong to cancel"),
        ({**CANCEL, "reach": 2}, "give at most 1"),
        ({"type": "move", "entity": SINK}, "move needs to"),
        ({"type": "smooth", "region": {}}, "is not one of center with radius, loop, or faces"),
        ({"type": "smooth", "region": {"center": [0, 0, 0]}}, "is not one of center with radius"),
        ({"type": "smooth", "region": {"faces": [1]}, "lam": [0.5, 0.1]}, "from 0.5 back to 0.1"),
        ({"type": "simplify"}, "simplify needs epsilon or keep"),
        ({"type": "simplify", "epsilon": float("nan")}, "epsilon has a number that is not finite"),
        ({"type": "move", "entity": {"kind": "sink", "at": [0, float("nan"), 0]}, "to": [0, 0, 0]}, "not finite"),
        ({"type": "twist"}, 'is "twist": use one of cancel, move, smooth, simplify'),
        ({"kind": "sink"}, "type is missing"),
    ],
)
def test_edits_that_say_too_little_or_too_much_are_refused(edit, fault):
    with pytest.raises(InputError, match=None) as caught:
        edits(edit)
    assert fault in str(caught.value)


def test_edits_of_another_schema_are_refused():
    with pytest.raises(InputError, match="a file of edits says"):
        edits_from_json({"schema": "stormfield.design/1", "edits": []})


def test_a_pair_is_cancelled_at_its_sample_and_fades_over_the_reach(surface):
    field = over_lambda(surface)
    edited = finish(edit_steps(field, edits({**CANCEL, "lam": 0.5, "reach": 0.4})))
    (report,) = edited.reports
    assert (report.status, report.reason, report.lam) == ("applied", "", (0.5,))
    assert report.to_json()["index"] == [0, 0, 0] and report.to_json()["left"] == []
    assert native.fixed_points(edited.field.sample(2)) == []
    # The pair ends before the middle and begins again behind it.
    assert report.bifurcations == (0, 2) and report.to_json()["bifurcations"] == {"before": 0, "after": 2}
    assert "makes 2 new bifurcations over λ" in notes_of(edited.reports)[0]
    changes = np.abs(np.asarray(edited.field.values) - np.asarray(field.values))
    assert (changes[0] == 0).all() and (changes[4] == 0).all()
    assert 0 < changes[1].max() < changes[2].max()
    np.testing.assert_allclose(changes[1], changes[3])
    outside = np.linalg.norm(surface.vertices[:, :2], axis=1) > 0.9
    assert (changes[:, outside] == 0).all()


def test_moving_and_smoothing(surface):
    field = over_lambda(surface, 1)
    move = {"type": "move", "entity": SINK, "to": [0.35, 0.2, 0.0]}
    edited = finish(edit_steps(field, edits(move)))
    assert edited.reports[0].status == "applied", edited.reports[0].reason
    kinds = {point.kind: point.position for point in native.fixed_points(edited.field.sample(0))}
    np.testing.assert_allclose(kinds["sink"], [0.35, 0.2, 0.0], atol=0.1 * surface.mean_edge_length)
    np.testing.assert_allclose(kinds["saddle"], [-0.287, 0.007, 0.0], atol=1e-2)
    smooth = {"type": "smooth", "region": {"center": [0, 0, 0], "radius": 0.7}}
    edited = finish(edit_steps(field, edits(smooth)))
    assert edited.reports[0].status == "applied"
    changed = np.asarray(edited.field.values)[0] != np.asarray(field.values)[0]
    assert changed.any() and np.linalg.norm(surface.vertices[changed], axis=1).max() < 0.7


def test_what_is_gone_is_skipped_and_said_so(surface):
    field = over_lambda(surface, 1)
    far = {"type": "move", "entity": {"kind": "sink", "at": [-0.9, 0.9, 0]}, "to": [0, 0, 0]}
    none = {"type": "cancel", "entities": [{"kind": "source", "at": [0, 0, 0]}, SADDLE]}
    bad = {"type": "smooth", "region": {"faces": [99999]}}
    edited = finish(edit_steps(field, edits(CANCEL, CANCEL, far, none, bad, {**CANCEL, "enabled": False})))
    assert [report.status for report in edited.reports] == ["applied", *["refused"] * 5]
    notes = notes_of(edited.reports)
    assert len(notes) == 4 and "edit 2 (cancel) was refused: the field has no sink here" in notes[0]
    assert "there is no face 99999" in notes[3]
    untouched = finish(edit_steps(field, edits(far, none, bad)))
    np.testing.assert_array_equal(untouched.field.values, field.values)
    assert "there is no sink within" in untouched.reports[0].reason


def test_simplify_reports_what_is_left():
    mesh = icosphere(5120)
    waves = np.random.default_rng(2).uniform(-3, 3, (2, 8, 3))
    vectors = np.sin(mesh.vertices @ waves[0].T) @ waves[1]
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    values = native.VectorField.from_space(surface, vectors).values
    field = native.ParameterizedField(surface, np.zeros(1), np.asarray(values)[None])
    edited = finish(edit_steps(field, edits({"type": "simplify", "keep": 4})))
    found = native.topology(edited.field.sample(0))
    count = len(found.fixed_points) + len(found.periodic_orbits)
    assert len(edited.reports[0].samples[0].left) == count
    assert count <= 4 or edited.reports[0].reason.startswith(f"{count} fixed points")


@pytest.fixture
def ply(tmp_path):
    vertices, triangles = plane()
    data = {name: fold(vertices)[:, k] for k, name in enumerate(("nx", "ny", "nz"))}
    path = tmp_path / "fold.ply"
    meshio.write(path, meshio.Mesh(vertices, [("triangle", triangles)], point_data=data), binary=False)
    return path


def write_edits(tmp_path, *given):
    path = tmp_path / "edits.json"
    path.write_text(json.dumps({"schema": "stormfield.edits/1", "edits": list(given)}))
    return path


def test_the_command_writes_a_cache_and_a_report(tmp_path, ply, capsys):
    file = write_edits(tmp_path, CANCEL, CANCEL)
    status, _, err = run(capsys, "edit", ply, file, "--out", tmp_path / "cache", "--json", tmp_path / "report.json")
    assert status == 0
    assert "note: edit 2 (cancel) was refused: the field has no sink here" in err
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["schema"] == "stormfield.edit/1"
    assert [edit["status"] for edit in report["edits"]] == ["applied", "refused"]
    assert set(report["edits"][0]["change"]) == {"angle", "length"}
    cache = open_cache(tmp_path / "cache")
    assert cache.settings["base"]["edits"] == [CANCEL, CANCEL]
    status, _, _ = run(capsys, "analyze", tmp_path / "cache", "--json", tmp_path / "after.json")
    assert status == 0 and json.loads((tmp_path / "after.json").read_text())["fixed_points"] == []


def test_the_command_refuses_files_it_cannot_read(tmp_path, ply, capsys):
    out = ("--out", tmp_path / "cache")
    assert "no such file" in refused(capsys, "edit", ply, tmp_path / "none.json", *out)
    (tmp_path / "broken.json").write_text("{")
    assert "is not JSON" in refused(capsys, "edit", ply, tmp_path / "broken.json", *out)
    line = refused(capsys, "edit", ply, write_edits(tmp_path, {"type": "cancel"}), *out)
    assert "edit 1: cancel needs entities" in line


def test_a_design_has_edits_and_its_cache_a_key_of_them(tmp_path, ply, capsys):
    elements = [
        {"name": "in", "type": "singular", "kind": "sink", "points": [[0.4, 0, 0]], "radius": 0.2},
        {"name": "x", "type": "singular", "kind": "saddle", "points": [[-0.4, 0, 0]], "radius": 0.2},
    ]
    content = {
        "schema": "stormfield.design/1",
        "mesh": {"file": ply.name},
        "settings": {"samples": 3},
        "elements": elements,
    }
    plain = Design.from_json(content)
    cancel = {**CANCEL, "lam": 0.5}
    edited = Design.from_json({**content, "edits": [cancel]})
    assert edited.to_json()["edits"] == [cancel] and "edits" not in plain.to_json()
    (tmp_path / "design.json").write_text(json.dumps({**content, "edits": [cancel]}))
    status, _, err = run(capsys, "solve", tmp_path / "design.json", "--out", tmp_path / "cache")
    assert status == 0, err
    cache = open_cache(tmp_path / "cache")
    surface = native.TriangleMesh(cache.mesh.vertices, cache.mesh.triangles)

    def kinds(j):
        vectors = cache.sample(j)["sf_advection"].astype(np.float64)
        return {point.kind for point in native.fixed_points(native.VectorField.from_space(surface, vectors))}

    assert {"sink", "saddle"} <= kinds(0) and {"sink", "saddle"} <= kinds(2)
    assert not {"sink", "saddle"} <= kinds(1)
    with pytest.raises(InputError, match="edit 1: cancel needs entities"):
        Design.from_json({**content, "edits": [{"type": "cancel"}]})


def test_the_core_refuses_a_topology_of_another_mesh(surface):
    other = native.TriangleMesh(*plane(8))
    field = native.VectorField.from_space(surface, fold(surface.vertices))
    foreign = native.topology(native.VectorField.from_space(other, fold(other.vertices)))
    with pytest.raises(InputError, match="another TriangleMesh"):
        native.cancel_pair(field, foreign, ("fixed_point", 0), ("fixed_point", 1))
    own = native.topology(field)
    plan = native.plan_cancel(field, own, ("fixed_point", 0), ("fixed_point", 1))
    assert plan.left == "nothing" and plan.index == (0, 0, 0) and len(plan.faces)
    assert native.entity_name(own, ("fixed_point", 0)).split()[0] in ("sink", "saddle")
    with pytest.raises(InputError, match="there is no entity 7"):
        native.entity_name(own, ("fixed_point", 7))
    with pytest.raises(InputError, match="was given twice"):
        native.plan_cancel(field, own, ("fixed_point", 0), ("fixed_point", 0))
    with pytest.raises(InputError, match="epsilon is -1"):
        native.simplify(field, own, epsilon=-1.0)


def test_a_cache_says_what_became_of_its_edits(tmp_path):
    from stormfield.bake.edited import Outcome, read_outcomes, write_outcomes

    outcomes = Outcome("applied", ""), Outcome("refused", "the field has no sink here")
    assert read_outcomes(tmp_path) == ()
    write_outcomes(tmp_path / "cache", outcomes)
    assert read_outcomes(tmp_path / "cache") == outcomes
    for broken in ("", "{", '[{"status": "applied"}]', "[1]", "3"):
        (tmp_path / "cache" / "edits.json").write_text(broken)
        assert read_outcomes(tmp_path / "cache") == ()
