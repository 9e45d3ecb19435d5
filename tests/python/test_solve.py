# SPDX-License-Identifier: GPL-3.0-or-later
"""From a design to fields: the job, its faults, and what the storms do in the solved samples."""

import time
from dataclasses import replace

import numpy as np
import pytest
from stormfield import native
from stormfield.model.design import Design, Element, SolveSettings
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.solve import SolverState, start_solve


def sphere(level: int) -> MeshData:
    """An octahedron divided `level` times."""
    points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    for _ in range(level):
        ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        edges, inverse = np.unique(ends, axis=0, return_inverse=True)
        ab, bc, ca = inverse.reshape(3, -1) + len(points)
        middle = points[edges].mean(axis=1)
        points = np.concatenate([points, middle / np.linalg.norm(middle, axis=1)[:, None]])
        a, b, c = faces.T
        faces = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return MeshData(points, faces)


def on(longitude, latitude):
    return (np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude))


def merge(kind="spiral_in_ccw", **settings) -> Design:
    def storm(name, start, end, lam):
        return Element(name, "singular", (on(*start), on(*end)), lam, kind=kind, radius=0.45)

    return Design(
        (
            storm("west", (-0.8, 0.2), (0.1, 0.1), (0.0, 0.6)),
            storm("east", (0.9, -0.1), (0.1, 0.1), (0.0, 0.6)),
            storm("one", (0.1, 0.1), (0.3, 0.3), (0.6, 1.0)),
        ),
        SolveSettings(**({"samples": 31} | settings)),
    )


def test_storms_merge():
    mesh = sphere(4)
    solution = start_solve(mesh, merge()).result()
    field = solution.fields["orientation"]
    assert solution.fields["advection"] is not None
    assert np.allclose(solution.lambdas, np.linspace(0, 1, 31))
    assert not solution.notes
    for j, lam in enumerate(solution.lambdas):
        found = native.fixed_points(field.sample(j))
        assert sum(p.index for p in found) == 2
        here = np.array(on(0.1, 0.1))
        storms = [p for p in found if p.index == 1 and p.position @ here > 0]
        assert len(storms) == (2 if lam < 0.6 - 1e-9 else 1), lam
        assert all(p.rotation > 0 for p in storms)


def test_job_reports_progress_and_is_done():
    job = start_solve(sphere(4), merge())
    seen = []
    while not job.done:
        seen.append(job.fraction)
        time.sleep(0.01)
    job.result()
    assert job.done and seen == sorted(seen) and all(0 <= f <= 1 for f in seen)


def test_cancel_stops_soon():
    job = start_solve(sphere(5), merge(samples=200))
    time.sleep(0.05)
    job.cancel()
    done = job.fraction
    with pytest.raises(native.Cancelled):
        job.result()
    assert job.fraction <= done + 0.1  # of the whole


def test_both_fields_are_solved_once_when_they_share_their_elements():
    solution = start_solve(sphere(3), merge()).result()
    assert solution.fields["orientation"] is solution.fields["advection"]


def test_fields_with_their_own_elements_differ():
    design = merge()
    band = Element(
        "band", "streamline", tuple(on(a, -0.8) for a in np.linspace(0, 2, 20)), field="advection", radius=0.2
    )
    solution = start_solve(sphere(3), Design((*design.elements, band), design.settings)).result()
    a, b = (solution.fields[name].values for name in ("orientation", "advection"))
    assert a.shape == b.shape and not np.allclose(a, b)


def test_a_field_without_elements_is_the_other():
    eye = Element("eye", "singular", (on(0, 0),), kind="source", field="orientation")
    solution = start_solve(sphere(3), Design((eye,), SolveSettings(samples=3))).result()
    assert solution.fields["advection"] is solution.fields["orientation"]


def test_a_solver_in_memory_needs_fewer_iterations():
    mesh, design, state = sphere(4), merge(tolerance=1e-6), SolverState()
    assert not state.holds(mesh)
    cold = start_solve(mesh, design, state).result()
    assert state.holds(mesh) and not state.holds(sphere(3))
    warm = start_solve(mesh, design, state).result()
    assert warm.iterations["orientation"] < cold.iterations["orientation"]
    np.testing.assert_allclose(warm.fields["orientation"].values, cold.fields["orientation"].values, atol=1e-4)
    state.clear()
    anew = start_solve(mesh, design, state).result()
    np.testing.assert_array_equal(anew.fields["orientation"].values, cold.fields["orientation"].values)


def test_memory_follows_to_another_mesh_sampling_and_number_of_fields():
    state = SolverState()
    for mesh, design in ((sphere(3), merge()), (sphere(4), merge()), (sphere(4), merge(samples=10))):
        result = start_solve(mesh, design, state).result()
        assert result.fields["advection"].values.shape == (len(result.lambdas), len(mesh.vertices))
    eye = Element("eye", "singular", (on(0, 0),), kind="source", field="orientation")
    two = replace(design, elements=(*design.elements, eye))
    result = start_solve(mesh, two, state).result()
    cold = start_solve(mesh, two).result()
    for name in ("orientation", "advection"):
        np.testing.assert_allclose(result.fields[name].values, cold.fields[name].values, atol=2e-3)


def test_a_stopped_solve_leaves_a_memory_to_go_on_with():
    mesh, state = sphere(4), SolverState()
    start_solve(mesh, merge(), state).result()
    stopped = start_solve(mesh, merge(tolerance=1e-9), state)
    stopped.cancel()
    with pytest.raises(native.Cancelled):
        stopped.result()
    start_solve(mesh, merge(), state).result()


def test_even_speed_keeps_the_flow_far_from_the_elements():
    mesh = sphere(4)
    plain, even = (start_solve(mesh, merge(even_speed=amount)).result().fields["orientation"] for amount in (0.0, 1.0))
    speeds = [np.abs(field.values[15]) for field in (plain, even)]
    slow = [np.quantile(speed, 0.2) / speed.max() for speed in speeds]
    print(f"slowest fifth, relative to the fastest: {slow[0]:.3f} as solved, {slow[1]:.3f} even")
    assert slow[1] > 2 * slow[0]


def test_parts_without_elements_are_reported():
    one = sphere(2)
    count = len(one.vertices)
    two = MeshData(
        np.concatenate([one.vertices, one.vertices + 5]), np.concatenate([one.triangles, one.triangles + count])
    )
    solution = start_solve(two, merge()).result()
    (note,) = solution.notes
    assert f"1 of 2 parts of the mesh has no element, so nothing flows there (part 2 with {count} vertices)" in note
    assert np.all(solution.fields["orientation"].values[:, count:] == 0)


@pytest.mark.parametrize(
    ("element", "said"),
    [
        (Element("X", "streamline", (on(0, 0), (2.0, 0, 0)), radius=0.1), 'curve "X" point 1 lies 1 off the surface'),
        (Element("X", "regular", (on(0, 0),)), 'regular element "X" has no direction'),
        (Element("X", "singular", (on(-0.8, 0.2),), kind="spiral_out_cw"), '"west".*"X".*contradict each other'),
        (Element("X", "singular", (on(0, 0),), (0, 1), kind="source", radius=-1), "radius -1"),
        (Element("X", "swirl", (on(0, 0),)), "type 'swirl'"),
    ],
)
def test_faults_of_a_design(element, said):
    design = merge()
    with pytest.raises(InputError, match=said):
        start_solve(sphere(4), Design((*design.elements, element), design.settings)).result()


def test_faults_of_a_mesh():
    with pytest.raises(InputError, match="face"):
        start_solve(MeshData(np.eye(3), [[0, 1, 1]]), merge())


def test_a_surface_is_made_once_while_the_mesh_and_the_settings_stay():
    mesh, state = sphere(4), SolverState()
    first = state.surface_of(mesh, SolveSettings())
    assert first.manifold is first.manifold and first.coarse is first.solved
    start_solve(mesh, merge(), state, first).result()
    equal = MeshData(mesh.vertices, mesh.triangles)
    assert state.surface_of(equal, SolveSettings()) is first
    assert state.surface_of(sphere(3), SolveSettings()) is not first
    finer = state.surface_of(equal, SolveSettings(edge=0.05))
    assert finer.solved.vertex_count > finer.coarse.vertex_count == first.coarse.vertex_count
    state.clear()
    assert state.surface_of(equal, SolveSettings()) is not first


def test_a_setting_that_changes_no_vertex_keeps_what_was_solved():
    mesh, state = sphere(4), SolverState()
    start_solve(mesh, merge(), state).result()
    before = state.surface_of(mesh, SolveSettings()).solved
    start_solve(mesh, merge(weld=1e-3), state).result()  # there is nothing to weld
    assert state.surface_of(mesh, SolveSettings(weld=1e-3)).solved is before
