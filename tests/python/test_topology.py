# SPDX-License-Identifier: GPL-3.0-or-later
"""The topology of fields in Python, as an entity graph, and on the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
import stormfield_native as native
from data_sets import data_set
from stormfield.analysis.ecg import entity_graph, topology_json
from stormfield.analysis.no_field import region_without_field, with_field
from stormfield.cli import main


def square(cells: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    axis = np.linspace(-size, size, cells + 1)
    x, y = np.meshgrid(axis, axis)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    a, b, c, d = corner, corner + 1, corner + cells + 2, corner + cells + 1
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), triangles.astype(np.int32)


def equation_31(points: np.ndarray) -> np.ndarray:
    """Thesis 3.3.1."""
    x, y = points[:, 0], points[:, 1]
    return np.stack([y, -x + y * np.cos(x), 0 * x], 1)


@pytest.fixture(scope="module")
def field() -> tuple:
    vertices, triangles = square(160, 3.999 * np.pi)
    mesh = native.TriangleMesh(vertices, triangles)
    return mesh, native.VectorField.from_space(mesh, equation_31(vertices))


@pytest.fixture(scope="module")
def topology(field):
    return native.start_topology(field[1]).result()


def test_finds_the_orbits(topology):
    assert [point.kind for point in topology.fixed_points] == ["source"]
    assert sorted(orbit.kind for orbit in topology.periodic_orbits) == ["attracting", "attracting", "repelling"]
    for orbit in topology.periodic_orbits:
        points = orbit.points
        assert np.array_equal(points[0], points[-1])
        assert len(points) == len(orbit.times) == len(orbit.faces) == len(orbit.barycentric)
        assert orbit.length == pytest.approx(np.linalg.norm(np.diff(points, axis=0), axis=1).sum(), rel=1e-2)
        assert orbit.times[-1] == pytest.approx(orbit.period)
        assert (orbit.multiplier < 1) == (orbit.kind == "attracting")
        assert not orbit.band
    assert set(topology.seconds) >= {"fixed_points", "recurrent_components", "streamlines", "links"}
    assert topology.zero_faces == 0


def test_makes_an_entity_graph(field, topology):
    graph = entity_graph(topology, 0.25)
    assert graph.lam == 0.25
    assert [entity.id for entity in graph.entities] == list(range(4))
    assert len({entity.name for entity in graph.entities}) == 4
    rows = {entity.kind: entity.row for entity in graph.entities}
    assert rows == {"source": "repelling", "attracting": "attracting", "repelling": "repelling"}
    assert len(graph.links) == 3
    for link in graph.links:
        assert graph.entities[link.source].row == "repelling"
        assert graph.entities[link.target].row == "attracting"
        assert link.curves == ()
    assert all(entity.strength > 0 for entity in graph.entities)


def test_links_follow_the_flow():
    vertices, triangles = square(40, 1.0)
    mesh = native.TriangleMesh(vertices, triangles)
    x, y = vertices[:, 0], vertices[:, 1]
    # Two sinks, a saddle between, everything comes from the boundary.
    vectors = np.stack([0.25 * x - x**3, -y, 0 * x], 1) + 1e-3
    found = native.start_topology(native.VectorField.from_space(mesh, vectors)).result()
    topology = with_field(found, region_without_field(mesh, vectors))
    graph = entity_graph(topology)
    assert sorted(entity.kind for entity in graph.entities) == ["saddle", "sink", "sink"]
    assert len(graph.links) == 2
    for link in graph.links:
        (curve,) = link.curves
        assert np.linalg.norm(curve[0] - graph.entities[link.source].position) < 0.05
        assert np.linalg.norm(curve[-1] - graph.entities[link.target].position) < 0.1
    saddle = next(p for p in topology.fixed_points if p.kind == "saddle")
    assert len(saddle.separatrix_directions) == 4
    assert [bool(outgoing) for _, outgoing in saddle.separatrix_directions].count(True) == 2
    assert saddle.eigenvalues[0].real > 0 > saddle.eigenvalues[1].real
    content = topology_json(topology, graph)
    assert content["index_sum"] + content["boundary_index_sum"] == 1
    assert {s["end"]["kind"] for s in content["separatrices"]} == {"fixed_point", "boundary"}
    json.dumps(content, allow_nan=False)


def test_reversing_the_field_turns_links_around(field, topology):
    mesh, instant = field
    back = native.start_topology(native.VectorField(mesh, -instant.values)).result()
    forward = {(source, target) for source, target, _ in topology.links}
    assert {(target, source) for source, target, _ in back.links} == forward
    assert [orbit.kind for orbit in back.periodic_orbits] == [
        {"attracting": "repelling", "repelling": "attracting"}[orbit.kind] for orbit in topology.periodic_orbits
    ]


def test_cancels():
    vertices, triangles = square(300, 10.999 * np.pi)
    mesh = native.TriangleMesh(vertices, triangles)
    job = native.start_topology(native.VectorField.from_space(mesh, equation_31(vertices)))
    job.cancel()
    with pytest.raises(native.Cancelled):
        job.result()


def test_refuses_bad_options(field):
    with pytest.raises(native.InputError, match="positive"):
        native.start_topology(field[1], tolerance=0.0).result()


def write_ply(path: Path, vertices: np.ndarray, triangles: np.ndarray, vectors: np.ndarray) -> None:
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    head += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    rows = [" ".join(f"{x:.9g}" for x in row) for row in np.hstack([vertices, vectors])]
    rows += [f"3 {a} {b} {c}" for a, b, c in triangles]
    path.write_text("\n".join(head + rows) + "\n")


def test_command_line(tmp_path):
    vertices, triangles = square(80, 2.999 * np.pi)
    write_ply(tmp_path / "field.ply", vertices, triangles, equation_31(vertices))
    out = tmp_path / "out.json"
    assert main(["analyze", str(tmp_path / "field.ply"), "--vector", "nx,ny,nz", "--json", str(out)]) == 0
    content = json.loads(out.read_text())
    for key in ("schema", "mesh", "lam", "seconds", "fixed_points", "periodic_orbits", "separatrices", "links"):
        assert key in content
    assert content["index_sum"] + content["boundary_index_sum"] == content["mesh"]["euler_characteristic"]
    assert sorted(orbit["kind"] for orbit in content["periodic_orbits"]) == ["attracting", "repelling"]
    assert content["zero_regions"] == {"faces": 0, "vertices": 1, "parts": 0}
    assert len(content["links"]) == 2


def test_command_line_reports_zeros_and_refuses_a_field_of_nothing_else(tmp_path):
    vertices, triangles = square(8, 1.0)
    vectors = np.where(vertices[:, [0]] > 0.9, [1.0, 0.0, 0.0], 0.0)
    write_ply(tmp_path / "some.ply", vertices, triangles, vectors)
    out = tmp_path / "out.json"
    assert main(["analyze", str(tmp_path / "some.ply"), "--vector", "nx,ny,nz", "--json", str(out)]) == 0
    assert json.loads(out.read_text())["zero_regions"]["vertices"] == int((vectors == 0).all(axis=1).sum()) > 0
    write_ply(tmp_path / "zero.ply", vertices, triangles, 0 * vertices)
    assert main(["analyze", str(tmp_path / "zero.ply"), "--vector", "nx,ny,nz", "--json", str(out)]) == 2


def test_command_line_on_the_gas_engine(tmp_path):
    out = tmp_path / "out.json"
    assert main(["analyze", str(data_set("gasEngineV.t")), "--json", str(out)]) == 0
    content = json.loads(out.read_text())
    assert content["index_sum"] == content["mesh"]["euler_characteristic"] == 2
    assert all(s["end"]["kind"] != "none" for s in content["separatrices"])
    assert len(content["periodic_orbits"]) >= 3


# Parts without a field ------------------------------------------------------------------------------------------------


def two_parts(cells: int = 30) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two squares; on the second, which comes first in the mesh, there is no field. On the other, two sinks and the
    saddle between them."""
    vertices, triangles = square(cells, 1.0)
    x, y = vertices[:, 0], vertices[:, 1]
    vectors = np.stack([0.25 * x - x**3, -y, 0 * x], 1) + 1e-3
    both = np.concatenate([vertices + np.array([5.0, 0.0, 0.0]), vertices])
    return both, np.concatenate([triangles, triangles + len(vertices)]), np.concatenate([0 * vectors, vectors])


def test_a_part_without_a_field_has_no_entities_and_is_reported():
    vertices, triangles, vectors = two_parts()
    mesh = native.TriangleMesh(vertices, triangles)
    everything = native.start_topology(native.VectorField.from_space(mesh, vectors)).result()
    assert len(everything.fixed_points) > 3  # what the core says of zeros
    region = region_without_field(mesh, vectors)
    assert (region.faces.sum(), region.parts) == (len(triangles) // 2, 1)
    assert "1 whole part" in region.note
    found = with_field(everything, region)
    graph = entity_graph(found)
    assert sorted(entity.kind for entity in graph.entities) == ["saddle", "sink", "sink"]
    assert [entity.name for entity in graph.entities if entity.kind == "saddle"] == ["S1"]
    alone = native.TriangleMesh(vertices[len(vertices) // 2 :], triangles[: len(triangles) // 2])
    single = native.start_topology(native.VectorField.from_space(alone, vectors[len(vertices) // 2 :])).result()
    content = topology_json(found, graph)
    assert content["index_sum"] == sum(point.index for point in single.fixed_points)
    assert len(content["links"]) == len(single.links) == 2
    assert len(content["separatrices"]) == len(single.separatrices)
    for link in content["links"]:  # numbers fit what is left
        assert content["separatrices"][link["separatrices"][0]]["saddle"] == link["source"]


def test_a_region_without_a_field_in_a_part_has_none_either():
    vertices, triangles = square(40, 1.0)
    mesh = native.TriangleMesh(vertices, triangles)
    vectors = np.stack([1.0 + 0 * vertices[:, 0], 0.3 * np.sin(4 * vertices[:, 1]), 0 * vertices[:, 0]], 1)
    vectors[np.linalg.norm(vertices[:, :2], axis=1) < 0.4] = 0.0
    region = region_without_field(mesh, vectors)
    found = with_field(native.start_topology(native.VectorField.from_space(mesh, vectors)).result(), region)
    assert region.parts == 0 and region.faces.sum() > 100
    assert not [p for p in found.fixed_points if np.linalg.norm(p.position) < 0.35]


def test_a_zero_at_one_vertex_stays_a_fixed_point():
    vertices, triangles = square(20, 1.0)
    mesh = native.TriangleMesh(vertices, triangles)
    vectors = vertices * (1.0, 1.0, 0.0)  # exactly zero at the middle vertex
    assert (vectors == 0.0).all(axis=1).sum() == 1
    region = region_without_field(mesh, vectors)
    assert region.note == ""
    found = with_field(native.start_topology(native.VectorField.from_space(mesh, vectors)).result(), region)
    assert [point.kind for point in found.fixed_points] == ["source"]


def test_paths_of_a_part_without_a_field_are_left_out():
    from stormfield.analysis import tracking

    vertices, triangles, vectors = two_parts(12)
    mesh = native.TriangleMesh(vertices, triangles)
    samples = np.array([native.VectorField.from_space(mesh, f * vectors).values for f in (1.0, 1.1, 1.2)])
    field = native.ParameterizedField(mesh, np.array([0.0, 0.5, 1.0]), samples)
    found = tracking.from_native(native.start_tracking(field).result(), region=region_without_field(mesh, samples))
    assert sorted(path.kind for path in found.paths) == ["saddle", "sink", "sink"]
    assert [path.id for path in found.paths] == [0, 1, 2]
    assert all(path.positions[:, 0].max() < 2.0 for path in found.paths)


def test_the_command_line_reports_a_region_without_a_field(tmp_path, capsys):
    import meshio

    vertices, triangles, vectors = two_parts(12)
    file = tmp_path / "parts.vtk"
    meshio.Mesh(vertices, [("triangle", triangles)], point_data={"wind": vectors}).write(file)
    assert main(["analyze", str(file), "--vector", "wind", "--json", str(tmp_path / "out.json")]) == 0
    content = json.loads((tmp_path / "out.json").read_text())
    assert sorted(point["kind"] for point in content["fixed_points"]) == ["saddle", "sink", "sink"]
    assert content["zero_regions"] == {"faces": len(triangles) // 2, "vertices": len(vertices) // 2, "parts": 1}
    assert "have no field" in capsys.readouterr().err
