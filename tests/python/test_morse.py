# SPDX-License-Identifier: GPL-3.0-or-later
"""Morse decompositions in Python: sets, indices, order, error bounds, graphs, JSON and the command line."""

import json
import time
from collections import Counter

import meshio
import numpy as np
import pytest
import stormfield_native as native
from data_sets import data_set
from stormfield.analysis.mcg import morse_graph, morse_json
from stormfield.analysis.steps import morse_steps
from stormfield.cli import main
from stormfield.model.mesh_data import MeshData
from stormfield.readers import read_field
from stormfield.readers.icosphere import icosphere
from stormfield.work import Stop, run

KINDS = {"source", "sink", "saddle", "attracting", "repelling", "trivial", "other"}


def sphere_field(rate, faces=5120):
    """On the unit sphere: rate(z) upwards, with a little rotation. Mesh and field."""
    data = icosphere(faces)
    p = data.vertices
    up = np.array([0, 0, 1.0]) - p[:, 2:] * p
    vectors = rate(p[:, 2:]) * up + 0.1 * np.cross([0, 0, 1.0], p)
    mesh = native.TriangleMesh(p, data.triangles)
    return mesh, native.VectorField.from_space(mesh, vectors)


def data_field(name):
    data = read_field(data_set(name))
    mesh = native.TriangleMesh(data.mesh.vertices, data.mesh.triangles)
    return mesh, native.VectorField.from_space(mesh, data.at(0.0))


def decompose(field, *args, **options):
    return native.start_morse(field, *args, **options).result()


def reachability(decomposition):
    n = len(decomposition.sets)
    reach = np.eye(n, dtype=bool)
    for a, b in decomposition.edges:
        reach[a, b] = True
    for k in range(n):
        reach |= reach[:, k : k + 1] & reach[k : k + 1, :]
    return reach


@pytest.fixture(scope="module")
def nested():
    """A source at each pole, attracting orbits at z = -0.4 and 0.5, a repelling one at 0.1."""
    return sphere_field(lambda z: -4 * (z + 0.4) * (z - 0.1) * (z - 0.5), 20480)


# Decompositions -------------------------------------------------------------------------------------------------------


def test_nested_orbits(nested):
    mesh, field = nested
    found = decompose(field)
    assert Counter(s.kind for s in found.sets) == {"attracting": 2, "repelling": 1, "source": 2}
    assert {s.kind: s.conley for s in found.sets} == {
        "attracting": (1, 1, 0), "repelling": (0, 1, 1), "source": (0, 0, 1)
    }  # fmt: skip
    assert sorted((found.sets[a].kind, found.sets[b].kind) for a, b in found.edges) == [
        ("repelling", "attracting"), ("repelling", "attracting"), ("source", "attracting"), ("source", "attracting")
    ]  # fmt: skip
    assert found.face_sets.shape == (mesh.face_count,) and found.face_sets.dtype == np.int32
    for number, morse_set in enumerate(found.sets):
        assert np.array_equal(np.flatnonzero(found.face_sets == number), morse_set.faces)
        assert not morse_set.outflow and not morse_set.upper_bound and morse_set.persistence > 0
    assert (found.method, found.tau, found.eps, found.upper_bound) == ("geometry", None, 0.0, False)


def test_connection_faces(nested):
    _, field = nested
    found = decompose(field)
    a, b = (int(i) for i in found.edges[0])
    between = found.connection_faces(a, b)
    assert len(between) > 50 and not set(between) & set(found.sets[a].faces)
    assert len(found.connection_faces(b, a)) == 0
    with pytest.raises(native.InputError, match="no Morse set 99; there are 5"):
        found.connection_faces(99, 0)


def test_simplify_is_the_decomposition_of_that_error(nested):
    _, field = nested
    found = decompose(field)
    merge = sorted({s.persistence for s in found.sets})
    for eps in [0.5 * merge[0], merge[0], 1.5 * merge[-1]]:
        simpler, direct = found.simplify(eps), decompose(field, eps=eps)
        assert np.array_equal(simpler.face_sets, direct.face_sets)
        assert np.array_equal(simpler.edges, direct.edges)
        assert [s.persistence for s in simpler.sets] == [s.persistence for s in direct.sets]
        assert simpler.eps == eps
    assert len(found.simplify(0.5 * merge[0]).sets) == len(found.sets)
    assert len(found.simplify(merge[0]).sets) < len(found.sets)
    assert len(found.simplify(1.5 * merge[-1]).sets) == 1


def test_trivial_sets_can_be_left_out(nested):
    _, field = nested
    eps = max(s.persistence for s in decompose(field).sets)
    for every in [decompose(field, keep_empty=True), decompose(field).simplify(0.9 * eps)]:
        wanted = [list(s.faces) for s in every.sets if s.kind != "trivial"]
        found = every.simplify(every.eps, keep_trivial=False)
        assert [list(s.faces) for s in found.sets] == wanted
        assert len(found.edges) == 0 or found.edges.max() < len(wanted)
    assert [list(s.faces) for s in decompose(field, eps=0.9 * eps, keep_trivial=False).sets] == wanted


def test_relative_errors_are_mean_speeds(nested):
    _, field = nested
    assert decompose(field, eps=0.1, relative=True).eps == pytest.approx(0.1 * native.mean_speed(field))


def test_zero_weights_forgive_nothing(nested):
    mesh, field = nested
    none = decompose(field, eps=10.0, weights=np.zeros(mesh.vertex_count))
    assert np.array_equal(none.face_sets, decompose(field).face_sets)
    assert all(s.persistence is None for s in none.sets)


@pytest.mark.parametrize("method", ["tau", "spatial"])
def test_maps_of_the_flow_bound_the_index(method):
    _, field = sphere_field(lambda z: 0 * z + 1.0, 1280)
    found = decompose(field, method)
    assert found.upper_bound and all(s.upper_bound and s.persistence is None for s in found.sets)
    assert Counter(s.kind for s in found.sets) == {"source": 1, "sink": 1}
    assert found.tau > 0 and found.method == method


# Refinement -----------------------------------------------------------------------------------------------------------


def strip_with_pair():
    """A square whose coarse sets hold more than one feature: a slow swirl around three fixed points."""
    axis = np.linspace(-1, 1, 31)
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    corner = (np.arange(30)[:, None] * 31 + np.arange(30)).ravel()
    a, b, c, d = corner, corner + 1, corner + 32, corner + 31
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    mesh = native.TriangleMesh(np.stack([x, y, 0 * x], 1), triangles)
    # Duffing's oscillator with friction: two sinks that spiral, a saddle between them.
    vectors = np.stack([y, 0.25 * x - x**3 - 0.1 * y, 0 * x], 1)
    return mesh, native.VectorField.from_space(mesh, vectors)


def test_refinement_takes_sets_apart():
    _, field = strip_with_pair()
    coarse = decompose(field)
    job = native.start_morse(field, "tau", refine=True)
    fine = job.result()
    assert fine.stop == "done" and job.fraction <= 1.0
    kinds = Counter(s.kind for s in fine.sets)
    assert kinds["sink"] == 2 and kinds["saddle"] == 1
    assert all(s.conley[0] - s.conley[1] + s.conley[2] == s.poincare for s in fine.sets)
    assert len(fine.sets) > len(coarse.sets)
    assert (fine.taus > 0).any() and fine.taus.max() == fine.tau
    for s in fine.sets:
        assert s.upper_bound == (fine.taus[s.faces] > 0).any()
        # Refined sets lie in coarse ones.
        assert len(np.unique(coarse.face_sets[s.faces])) == 1 and coarse.face_sets[s.faces[0]] >= 0


def test_geometry_refines_inside_faces():
    _, field = strip_with_pair()
    fine = native.start_morse(field, refine=True).result()
    assert fine.stop == "done" and fine.method == "geometry" and fine.tau is None and not fine.upper_bound
    kinds = Counter(s.kind for s in fine.sets if s.kind != "trivial")
    assert kinds == {"sink": 2, "saddle": 1}
    for i, s in enumerate(fine.sets):
        assert s.conley[0] - s.conley[1] + s.conley[2] == s.poincare
        assert set(np.flatnonzero(fine.face_sets == i)) <= set(s.faces)
    assert fine.start_refine_set(0).result().method == "geometry"


def test_refinement_with_an_error_bound():
    _, field = strip_with_pair()
    fine = native.start_morse(field, refine=True, eps=0.01, relative=True, persistence=True).result()
    assert fine.stop == "done" and fine.eps == pytest.approx(0.01 * native.mean_speed(field))
    assert Counter(s.kind for s in fine.sets if s.kind != "trivial") == {"sink": 2, "saddle": 1}
    merge = [s.persistence for s in fine.sets]
    assert all(value is None or value > fine.eps for value in merge) and any(merge)
    simpler = fine.simplify(max(value for value in merge if value))
    # Where nothing was refined, faces that some field rests in make sets that are trivial.
    assert sum(s.kind != "trivial" for s in simpler.sets) < 3
    assert simpler.eps > fine.eps and simpler.stop == "done"
    assert all(s.persistence is None for s in native.start_morse(field, refine=True).result().sets)


def test_one_set_is_refined_by_hand():
    _, field = strip_with_pair()
    found = decompose(field)
    largest = max(range(len(found.sets)), key=lambda i: len(found.sets[i].faces))
    finer = found.start_refine_set(largest).result()
    assert finer.method == "tau" and finer.tau > 0
    refined = np.flatnonzero(finer.taus > 0)
    assert set(refined) <= set(found.sets[largest].faces.tolist())
    assert sum(len(s.faces) for s in finer.sets) < sum(len(s.faces) for s in found.sets)
    with pytest.raises(native.InputError, match="no Morse set 77"):
        found.start_refine_set(77).result()
    with pytest.raises(native.InputError, match="set by set"):
        decompose(field, eps=0.01).start_refine_set(0).result()


def test_cancelled_refinement_is_a_decomposition():
    mesh, field = data_field("bunny1V.t")
    job = native.start_morse(field, "tau", refine=True)
    job.cancel()
    found = job.result()
    assert found.stop == "cancelled"
    assert sum(s.poincare for s in found.sets) == mesh.euler_characteristic


def test_stopped_steps_give_what_is_complete():
    mesh, field = data_field("gasEngineV.t")
    data = MeshData(np.asarray(mesh.vertices), np.asarray(mesh.triangles))
    steps = morse_steps(data, field.to_space(), 0.0, method="tau", refine=True)
    while "Dividing" not in next(steps).message:
        pass
    steps.throw(Stop())
    found = run(steps)
    assert found.decomposition.stop in {"cancelled", "done"}
    assert sum(s.poincare for s in found.decomposition.sets) == mesh.euler_characteristic


# Bad input ------------------------------------------------------------------------------------------------------------


def test_refuses_bad_options(nested):
    mesh, field = nested
    refused = [
        ({"method": "magic"}, "no Morse method 'magic'.*geometry, tau or spatial"),
        ({"eps": -1.0}, "eps is -1"),
        ({"eps": float("nan")}, "eps is nan"),
        ({"eps": float("inf")}, "eps is inf"),
        ({"tau": 0.1}, "'geometry' has no tau"),
        ({"refine": True, "tau": 1.0}, "'geometry' has no tau"),
        ({"method": "tau", "tau_max": 1.0}, "tau_max is for refinement"),
        ({"method": "tau", "refine": True, "tau_max": -1.0}, "tau"),
        ({"method": "tau", "refine": True, "max_seconds": 0.0}, "limit of time"),
        ({"method": "tau", "tau": 0.1, "eps": 0.1}, "error bound needs the geometry-based map"),
        ({"method": "tau", "tau": -1.0}, "tau"),
        ({"method": "spatial", "tau": float("nan")}, "tau"),
        ({"weights": np.ones(3)}, "weights"),
        ({"weights": np.full(mesh.vertex_count, -1.0)}, "vertex 0"),
    ]
    for options, message in refused:
        with pytest.raises(native.InputError, match=message):
            decompose(field, **options)
    with pytest.raises(native.InputError, match="eps is -1"):
        decompose(field).simplify(-1.0)


def test_zero_field_is_one_set():
    mesh, _ = sphere_field(lambda z: z, 1280)
    zero = native.VectorField.from_space(mesh, np.zeros((mesh.vertex_count, 3)))
    (whole,) = decompose(zero).sets
    assert whole.conley == (1, 0, 1) and len(whole.faces) == mesh.face_count
    with pytest.raises(native.InputError, match="zero"):
        decompose(zero, "tau")


def test_cancel_stops_soon():
    _, field = sphere_field(lambda z: z - 0.2, 327680)
    job = native.start_morse(field)
    time.sleep(0.05)
    job.cancel()
    done = job.fraction
    with pytest.raises(native.Cancelled):
        job.result()
    assert job.fraction <= done + 0.1  # of the whole


# Real data ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["gasEngineV.t", "bunny1V.t", "torus1V.t", "sphere1.ply"])
def test_indices_add_up(name):
    mesh, field = data_field(name)
    for eps in [0.0, 0.02]:
        found = decompose(field, eps=eps, relative=True)
        assert len(found.sets) > 3
        assert sum(b0 - b1 + b2 for b0, b1, b2 in (s.conley for s in found.sets)) == mesh.euler_characteristic
        for s in found.sets:
            assert s.conley[0] - s.conley[1] + s.conley[2] == s.poincare
            assert s.poincare == field.poincare_indices()[s.faces].sum()


def test_gas_engine_under_noise():
    """100 of 100 runs keep the graph of the error bound, while fixed points come and go."""
    mesh, field = data_field("gasEngineV.t")
    eps = 0.02 * native.mean_speed(field)
    bound = decompose(field, eps=eps)
    reach = reachability(bound)
    before = len(native.fixed_points(field))
    rng = np.random.default_rng(1)
    changed = 0
    for _ in range(100):
        size = eps * np.sqrt(rng.uniform(size=mesh.vertex_count))
        noise = size * np.exp(2j * np.pi * rng.uniform(size=mesh.vertex_count))
        disturbed = native.VectorField(mesh, field.values + noise)
        found = decompose(disturbed, persistence=False)
        inside = [np.unique(bound.face_sets[s.faces]) for s in found.sets]
        assert all(len(sets) == 1 and sets[0] >= 0 for sets in inside)
        where = [int(sets[0]) for sets in inside]
        assert all(reach[where[a], where[b]] for a, b in found.edges)
        assert {n for n, s in enumerate(bound.sets) if s.kind != "trivial"} <= set(where)
        changed += len(native.fixed_points(disturbed)) != before
    print(f"graph kept in 100 of 100 runs, other number of fixed points in {changed}")
    assert changed > 50


# Graph, JSON, command line --------------------------------------------------------------------------------------------


def test_graph_of_entities(nested):
    mesh, field = nested
    found = decompose(field)
    graph = morse_graph(found, mesh, 0.25)
    assert graph.title == "Morse connection graph" and graph.lam == 0.25
    assert sorted(entity.name for entity in graph.entities) == ["A1", "A2", "R1", "R2", "R3"]
    assert {entity.row for entity in graph.entities} == {"attracting", "repelling"}
    assert [(link.source, link.target) for link in graph.links] == [tuple(edge) for edge in found.edges.tolist()]
    for entity, morse_set in zip(graph.entities, found.sets, strict=True):
        assert np.array_equal(entity.faces, morse_set.faces)
        centres = mesh.vertices[mesh.triangles[morse_set.faces]].mean(axis=1)
        assert (np.abs(centres - entity.position).sum(axis=1) == 0).any()
        assert entity.strength == morse_set.persistence
    json.dumps(morse_json(found, graph), allow_nan=False)
    assert sum(entity.info["area"] for entity in graph.entities) < 4 * np.pi


@pytest.fixture(scope="module")
def ply(tmp_path_factory, nested):
    mesh, field = nested
    vectors = field.to_space()
    path = tmp_path_factory.mktemp("data") / "nested.ply"
    data = {name: vectors[:, k] for k, name in enumerate(("nx", "ny", "nz"))}
    meshio.write(path, meshio.Mesh(mesh.vertices, [("triangle", mesh.triangles)], point_data=data), binary=False)
    return path


def test_command_line(capsys, ply, tmp_path):
    out = tmp_path / "morse.json"
    assert main(["morse", str(ply), "--json", str(out)]) == 0
    content = json.loads(out.read_text())
    assert content.keys() == {
        *("schema", "read", "mesh", "lam", "method", "tau", "refinement", "eps", "upper_bound"),
        *("map_edges", "morse_sets", "edges", "seconds"),
    }
    assert content["schema"] == "stormfield.morse/1" and content["mesh"]["euler_characteristic"] == 2
    assert content["seconds"].keys() == {"read", "mesh", "map", "sets", "persistence", "graph"}
    assert len(content["morse_sets"]) == 5 and len(content["edges"]) == 4 and content["map_edges"] > 20480
    for morse_set in content["morse_sets"]:
        assert morse_set["kind"] in KINDS and len(morse_set["conley"]) == 3
        assert morse_set["persistence"] > 0 and len(morse_set["faces"]) > 0
    assert capsys.readouterr().out == ""


def test_command_line_simplifies(capsys, ply):
    assert main(["morse", str(ply), "--eps", "3", "--relative", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert len(content["morse_sets"]) == 1 and content["morse_sets"][0]["conley"] == [1, 0, 1]
    assert content["morse_sets"][0]["persistence"] is None


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--eps", "-1"], "eps is -1"),
        (["--tau", "1"], "no tau"),
        (["--method", "tau", "--tau", "-1"], "tau"),
        (["--method", "magic"], "magic"),
        (["--lam", "2"], "outside 0..1"),
    ],
)
def test_command_line_refuses(capsys, ply, options, says):
    assert main(["morse", str(ply), *options, "--json", "-"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1 and says in captured.err


# Beside the entity connection graph -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["gasEngineV.t", "bunny1V.t", "sphere1.ply", "simple_fld2.ply"])
def test_entities_lie_in_morse_sets_and_their_links_follow_the_order(name):
    _, field = data_field(name)
    topology = native.start_topology(field).result()
    for eps in [0.0, 0.01]:
        found = decompose(field, eps=eps, relative=True)
        where = [found.face_sets[point.face] for point in topology.fixed_points]
        for orbit in topology.periodic_orbits:
            sets = np.unique(found.face_sets[orbit.faces])
            assert len(sets) == 1
            where.append(sets[0])
        assert len(where) > 3 and min(where) >= 0
        reach = reachability(found)
        points = len(topology.fixed_points)
        ends = {"fixed_point": 0, "periodic_orbit": points}
        for source, target, _ in topology.links:
            a, b = (where[ends[kind] + number] for kind, number in (source, target))
            assert reach[a, b]
