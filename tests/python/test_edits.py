# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits: the data, what they do to a field over λ, the command, and the edits of a design."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from command_line import refused, run
from data_sets import data_set
from stormfield import native
from stormfield.cache.field_cache import open_cache
from stormfield.edits import edit_steps, notes_of, to_json
from stormfield.model.design import Design
from stormfield.model.edits import edits_from_json
from stormfield.model.errors import InputError
from stormfield.readers import read_field
from stormfield.readers.icosphere import icosphere
from stormfield.work import run as finish

SCRIPTS = Path(__file__).parents[2] / "scripts"


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
        ({"type": "twist"}, 'is "twist": use one of cancel, move, smooth, simplify, transform'),
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


def test_a_reach_beyond_the_ends_of_lambda_changes_what_is_there(surface):
    field = over_lambda(surface)
    edited = finish(edit_steps(field, edits({**CANCEL, "lam": 0.0, "reach": 1.0})))
    assert edited.reports[0].status == "applied", edited.reports[0].reason
    changed = np.abs(np.asarray(edited.field.values) - np.asarray(field.values)).max(axis=1)
    assert (np.diff(changed) < 0).all() and changed[-1] < 1e-12


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
    assert set(report["edits"][0]["change"]) == {"angle", "length"} and report["edits"][0]["seconds"] > 0
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


# Turning over λ -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("edit", "fault"),
    [
        ({}, "transform needs angle, scale or stretch"),
        ({"angle": 90, "reach": 0.1}, "reach does not belong to transform"),
        ({"angle": 90, "lam": [0.8, 0.2]}, "from 0.8 back to 0.2"),
        ({"angle": float("nan")}, "angle has a number that is not finite"),
        ({"scale": 0}, "is 0, and takes: A number above 0"),
        ({"scale": [[0, 1], [1, -1]]}, "scale is a factor: give numbers above 0"),
        ({"angle": [[0.5, 1], [0.5, 2]]}, "angle at λ 0.5 does not come after the one before"),
        ({"stretch": 2, "axis": [0, 0, 0]}, "the axis has no length"),
        ({"stretch": 2, "axis": "advection"}, 'is "advection", and takes'),
        ({"angle": 90, "axis": [1, 0, 0]}, "an axis belongs to stretch"),
        ({"angle": 90, "falloff": 0.1}, "falloff belongs to a region"),
    ],
)
def test_transforms_that_cannot_be_are_refused(edit, fault):
    with pytest.raises(InputError) as caught:
        edits({"type": "transform", **edit})
    assert fault in str(caught.value)


def varying(surface, samples=11):
    """A field that moves over λ."""
    x, y = surface.vertices[:, 0], surface.vertices[:, 1]
    values = [
        native.VectorField.from_space(surface, np.column_stack([y + lam, x - 0.2 * lam, 0 * x])).values
        for lam in np.linspace(0.0, 1.0, samples)
    ]
    return native.ParameterizedField(surface, np.linspace(0.0, 1.0, samples), np.array(values))


def after(field, *given, orientation=None):
    edited = finish(edit_steps(field, edits(*given), orientation=orientation))
    assert [report.status for report in edited.reports] == ["applied"] * len(given), edited.reports
    return np.asarray(edited.field.values)


def test_every_vector_turns_by_the_exact_angle(surface):
    field = varying(surface)
    before, lambdas = np.asarray(field.values), np.asarray(field.lambdas)
    turned = after(field, {"type": "transform", "angle": 70, "scale": 3, "lam": [0.25, 0.75]})
    part = np.clip((lambdas - 0.25) / 0.5, 0.0, 1.0)[:, None]
    np.testing.assert_allclose(turned, before * 3**part * np.exp(1j * np.radians(70) * part), rtol=0, atol=1e-12)
    assert turned[:3].tobytes() == before[:3].tobytes()  # before it begins


def test_keys_say_where_it_turns(surface):
    field = varying(surface)
    turned = after(field, {"type": "transform", "angle": [[0, 0], [0.5, 180], [1, 0]]})
    before = np.asarray(field.values)
    np.testing.assert_allclose(turned[5], -before[5], atol=1e-12)
    np.testing.assert_allclose(turned[10], before[10], atol=1e-12)
    at_once = after(field, {"type": "transform", "angle": 180, "lam": 0.5})
    assert at_once[:5].tobytes() == before[:5].tobytes()
    np.testing.assert_allclose(at_once[5:], -before[5:], atol=1e-12)


def test_one_that_is_frozen_stays_in_its_first_field(surface):
    field = varying(surface)
    turned = after(field, {"type": "transform", "angle": 90, "frozen": True, "lam": [0.3, 0.6]})
    start = np.asarray(field.values)[3]
    for j in (6, 8, 10):
        np.testing.assert_allclose(turned[j], 1j * start, atol=1e-12)


def test_a_stretch_has_an_axis(surface):
    field = varying(surface)
    flat = surface.to_space(after(field, {"type": "transform", "stretch": 4, "axis": [2, 0, 0]}))
    np.testing.assert_allclose(flat[10], surface.to_space(np.asarray(field.values)[10]) * (4, 1, 1), atol=1e-12)
    up = np.tile((0.0, 1.0, 0.0), (surface.vertex_count, 1))
    up = np.tile(native.VectorField.from_space(surface, up).values, (11, 1))
    orientation = native.ParameterizedField(surface, field.lambdas, up)
    along = surface.to_space(after(field, {"type": "transform", "stretch": 4}, orientation=orientation))
    np.testing.assert_allclose(along[10], surface.to_space(np.asarray(field.values)[10]) * (1, 4, 1), atol=1e-12)
    own = after(field, {"type": "transform", "stretch": 4})  # along itself is longer
    np.testing.assert_allclose(own, after(field, {"type": "transform", "scale": 4}), atol=1e-12)


def test_a_region_fades_out(surface):
    field = varying(surface, 2)
    region = {"center": [0, 0, 0], "radius": 0.4}
    turned = after(field, {"type": "transform", "angle": 90, "region": region, "falloff": 0.2})
    changed = np.asarray(field.values)[1] != turned[1]
    away = np.linalg.norm(surface.vertices, axis=1)
    assert changed[away < 0.35].all() and not changed[away > 0.6].any()
    np.testing.assert_allclose(turned[1][away < 0.35], 1j * np.asarray(field.values)[1][away < 0.35], atol=1e-12)


# What is done again ---------------------------------------------------------------------------------------------------


def untimed(reports):
    return [{name: value for name, value in report.items() if name != "seconds"} for report in to_json(reports)]


def test_only_what_was_changed_is_done_again(surface, monkeypatch):
    from stormfield import edits as module
    from stormfield.edits.memory import EditMemory

    field, memory, done = over_lambda(surface, 11), EditMemory(), []
    plain = module.edit_sample
    monkeypatch.setattr(module, "edit_sample", lambda sample, edit: (done.append(edit), plain(sample, edit))[1])

    def apply(*given):
        done.clear()
        edited = finish(edit_steps(field, edits(*given), memory=memory))
        count = len(done)
        fresh = finish(edit_steps(field, edits(*given)))
        assert edited.field.values.tobytes() == fresh.field.values.tobytes()
        assert untimed(edited.reports) == untimed(fresh.reports)
        return count

    disc = {"type": "smooth", "region": {"center": [0, 0, 0], "radius": 0.5}}
    early, late = {**disc, "lam": 0.1, "reach": 0.15}, {**disc, "lam": 0.9, "reach": 0.15}
    assert apply(CANCEL, early, late) == 3
    assert apply(CANCEL, early, late) == 0
    assert apply(CANCEL, early, {**late, "reach": 0.2}) == 1
    assert apply(CANCEL, {**early, "enabled": False}, late) == 0  # far away in λ from what was turned off
    assert apply({**CANCEL, "lam": 0.1}, early, late) == 2  # what follows in the same λ


def test_memory_gives_back_what_was_not_used(surface):
    from stormfield.edits.memory import EditMemory, Made
    from stormfield.edits.report import EditReport

    memory = EditMemory(limit=100)
    for name in "abc":
        memory.keep(name, Made(np.zeros(5), EditReport("smooth", "applied", "")))
    assert memory.find("a") is None and memory.find("b") is not None and memory.find("c") is not None


# Both fields of a cache -----------------------------------------------------------------------------------------------


@pytest.fixture
def two_fields(tmp_path):
    """A cache whose orientation is another field than its advection."""
    from stormfield.bake.given import GivenField, given_steps
    from stormfield.model.mesh_data import MeshData

    vertices, triangles = plane()
    moves, turns = fold(vertices), np.tile((0.0, 1.0, 0.0), (len(vertices), 1))
    given = GivenField((0.0, 1.0), [moves, moves], {"of": "a test"}, [turns, turns])
    return finish(given_steps(MeshData(vertices, triangles), given, tmp_path, folder=tmp_path / "two"))


def sample(folder, name):
    return open_cache(folder).sample(0)[name]


def test_the_command_keeps_both_fields_of_a_cache(tmp_path, two_fields, capsys):
    out = tmp_path / "cache"
    file, told = write_edits(tmp_path, CANCEL), tmp_path / "report.json"
    status, _, err = run(capsys, "edit", two_fields, file, "--out", out, "--json", told)
    assert status == 0 and "orientation: edit 1 (cancel) was refused: the field has no" in err
    assert sample(out, "sf_orientation").tobytes() == sample(two_fields, "sf_orientation").tobytes()
    assert sample(out, "sf_advection").tobytes() != sample(two_fields, "sf_advection").tobytes()
    (report,) = json.loads(told.read_text())["edits"]
    assert report["status"] == "applied"
    assert {name: its["status"] for name, its in report["fields"].items()} == {
        "orientation": "refused",
        "advection": "applied",
    }


def test_the_command_edits_the_field_that_is_asked_for(tmp_path, two_fields, capsys):
    turn = write_edits(tmp_path, {"type": "transform", "angle": 90, "lam": 0})
    status, _, _ = run(capsys, "edit", two_fields, turn, "--out", tmp_path / "a", "--attribute", "sf_orientation")
    assert status == 0
    np.testing.assert_allclose(sample(tmp_path / "a", "sf_orientation")[:, 0], -1.0, atol=1e-6)
    assert sample(tmp_path / "a", "sf_advection").tobytes() == sample(two_fields, "sf_advection").tobytes()
    named = write_edits(tmp_path, {"type": "transform", "angle": 90, "lam": 0, "field": "advection"})
    status, _, _ = run(capsys, "edit", two_fields, named, "--out", tmp_path / "b")
    assert status == 0
    assert sample(tmp_path / "b", "sf_orientation").tobytes() == sample(two_fields, "sf_orientation").tobytes()
    before, turned = sample(two_fields, "sf_advection"), sample(tmp_path / "b", "sf_advection")
    np.testing.assert_allclose(turned[:, 0], -before[:, 1], atol=1e-6)


def test_other_edits_do_not_solve_again(tmp_path, monkeypatch):
    from stormfield.bake import lambda_cache
    from stormfield.bake.reuse import Reuse
    from stormfield.model.mesh_data import MeshData

    vertices, triangles = plane(12)
    elements = [
        {"name": "in", "type": "singular", "kind": "sink", "points": [[0.4, 0, 0]], "radius": 0.2},
        {"name": "x", "type": "singular", "kind": "saddle", "points": [[-0.4, 0, 0]], "radius": 0.2},
    ]
    content = {"schema": "stormfield.design/1", "mesh": {"file": "m"}, "settings": {"samples": 3}, "elements": elements}
    solved, plain = [], lambda_cache.start_solve
    monkeypatch.setattr(lambda_cache, "start_solve", lambda *given: (solved.append(1), plain(*given))[1])
    mesh, reuse = MeshData(vertices, triangles), Reuse()
    smooth = {"type": "smooth", "region": {"faces": list(range(200))}, "lam": 0.5}
    for count, given in ((1, []), (1, [smooth]), (1, [{**smooth, "lam": 1}]), (1, [])):
        design = Design.from_json({**content, "edits": given})
        folder = finish(lambda_cache.solve_steps(mesh, design, tmp_path / "a", reuse=reuse))
        assert len(solved) == count
        fresh = finish(lambda_cache.solve_steps(mesh, design, tmp_path / "b"))
        solved.pop()
        assert folder.name == fresh.name
        for j in range(3):
            for name, values in open_cache(folder).sample(j).items():
                assert values.tobytes() == open_cache(fresh).sample(j)[name].tobytes()


def test_faces_of_a_mesh_are_found_on_the_surface_that_was_solved(tmp_path):
    """A finer surface: the same region, whatever the solver divides."""
    from stormfield.bake.edited import edited_solution
    from stormfield.model.mesh_data import MeshData
    from stormfield.solve import solve

    vertices, triangles = plane(12)
    middle = vertices[triangles].mean(axis=1)
    chosen = np.flatnonzero(np.linalg.norm(middle, axis=1) < 0.5).tolist()
    content = {
        "schema": "stormfield.design/1",
        "mesh": {"file": "m"},
        "settings": {"samples": 1, "edge": 0.15},
        "elements": [{"name": "x", "type": "singular", "kind": "saddle", "points": [[-0.4, 0, 0]], "radius": 0.2}],
        "edits": [{"type": "transform", "angle": 90, "lam": 0, "region": {"faces": chosen}}],
    }
    design = Design.from_json(content)
    solution = solve(MeshData(vertices, triangles), design)
    edited = finish(edited_solution(solution, design))
    before, after_edit = (one.fields["advection"] for one in (solution, edited.solution))
    assert before.mesh.vertex_count > len(vertices)
    changed = (np.asarray(before.values) != np.asarray(after_edit.values))[0]
    away = np.linalg.norm(np.asarray(before.mesh.vertices), axis=1)
    assert changed[away < 0.35].all() and not changed[away > 0.7].any()
    gone = Design.from_json({**content, "edits": [{**content["edits"][0], "region": {"faces": [99999]}}]})
    assert "there is no face 99999" in finish(edited_solution(solution, gone)).outcomes[0].reason


# The gas engine -------------------------------------------------------------------------------------------------------


def test_six_regions_of_a_user_simplify_the_gas_engine():
    """Thesis figure 4.4: five to six smoothed regions leave the large tumble and little else."""
    regions = edits_from_json(json.loads((SCRIPTS / "engine_smoothing.json").read_text()))
    assert len(regions) == 6 and {edit.type for edit in regions} == {"smooth"}
    data = read_field(data_set("gasEngineV.t"))
    mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    before = native.VectorField.from_space(mesh, np.asarray(data.vectors[0], np.float64))
    one = native.ParameterizedField(mesh, np.zeros(1), np.asarray(before.values)[None])
    edited = finish(edit_steps(one, regions))
    assert [report.status for report in edited.reports] == ["applied"] * 6
    after = edited.field.sample(0)
    counts = [len(found.fixed_points) + len(found.periodic_orbits) for found in map(native.topology, (before, after))]
    assert counts[0] == 64 and counts[1] <= 16
    # The tumble ends in two sinks on the far wall, which stand where they stood; no region is near.
    tumble = [p.position for p in native.fixed_points(before) if p.kind == "sink" and p.position[1] < -0.05]
    found = [p.position for p in native.fixed_points(after)]
    assert len(tumble) == 2 and all(any(np.array_equal(place, own) for own in found) for place in tumble)
    inside = np.zeros(mesh.vertex_count, bool)
    for report in edited.reports:
        inside[np.asarray(mesh.triangles)[list(report.samples[0].faces)]] = True
    np.testing.assert_array_equal(np.asarray(after.values)[~inside], np.asarray(before.values)[~inside])
    assert 0.05 < inside.mean() < 0.4
    assert sum(after.poincare_indices()) == sum(before.poincare_indices())
