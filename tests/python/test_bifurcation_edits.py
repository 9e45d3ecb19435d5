# SPDX-License-Identifier: GPL-3.0-or-later
"""Removing and moving bifurcations: normal forms with known answers, and what is refused."""

import numpy as np
import pytest
from stormfield import native
from stormfield.edits import edit_steps
from stormfield.model.edits import edits_from_json
from stormfield.model.errors import InputError
from stormfield.work import run as finish
from test_edits import edits, plane


@pytest.fixture(scope="module")
def surface():
    return native.TriangleMesh(*plane(48))


def over_lambda(surface, opening, samples=21):
    """At y = -0.5 a sink and a saddle at x = ±sqrt(opening(λ)); at y = 0.5 a source and a saddle that stay."""
    lambdas = np.linspace(0.0, 1.0, samples)
    x, y = surface.vertices[:, 0] - 0.0137, surface.vertices[:, 1] - 0.0071
    rows = []
    for lam in lambdas:
        part = np.clip(0.5 - y, 0.0, 1.0)
        width = part * opening(lam) + (1.0 - part) * 0.09
        space = np.column_stack([width - x * x, y * y - 0.25, np.zeros(len(x))])
        rows.append(np.asarray(native.VectorField.from_space(surface, space).values))
    return native.ParameterizedField(surface, lambdas, np.stack(rows))


def bubble(lam):
    return 0.09 * (1.0 - ((lam - 0.507) / 0.307) ** 2)


def gap(lam):
    return -bubble(lam)


def birth(lam):
    return 0.2 * (lam - 0.507)


def hysteresis(surface, samples=21):
    """A sink; a saddle and a second sink appear; the saddle meets the first sink."""
    lambdas = np.linspace(0.0, 1.0, samples)
    x, y = surface.vertices[:, 0] - 0.0137, surface.vertices[:, 1] - 0.0071
    rows = []
    for lam in lambdas:
        space = np.column_stack([0.3 * x - x**3 + 0.2 * (lam - 0.5), -y, np.zeros(len(x))])
        rows.append(np.asarray(native.VectorField.from_space(surface, space).values))
    return native.ParameterizedField(surface, lambdas, np.stack(rows))


def tracked(field):
    return native.start_tracking(field).result()


def event_of(field, kind):
    return next(event for event in tracked(field).bifurcations if event.kind == kind)


def named(event, **more):
    return {"at": list(map(float, event.position)), "lam": float(event.lam), **more}


def done(field, edit):
    edited = finish(edit_steps(field, edits(edit)))
    (report,) = edited.reports
    return edited.field, report


def paths_beside(field):
    """Lives and mean places of the paths at y = 0.5."""
    return [
        (path.kind, path.lambdas[[0, -1]].tolist(), path.positions)
        for path in tracked(field).paths
        if path.positions[0, 1] > 0
    ]


def expect_others_as_before(before, after):
    for (kind, life, places), (kind_after, life_after, places_after) in zip(
        paths_beside(before), paths_beside(after), strict=True
    ):
        assert (kind, life) == (kind_after, life_after)
        np.testing.assert_allclose(places, places_after, atol=1e-6)


@pytest.mark.parametrize("kind", ["creation", "annihilation"])
def test_a_bubble_is_removed_with_both_its_bifurcations(surface, kind):
    field = over_lambda(surface, bubble)
    assert len(tracked(field).bifurcations) == 2
    after, report = done(field, {"type": "remove_bifurcation", **named(event_of(field, kind)), "reach": 0.1})
    assert report.status == "applied", report.reason
    assert report.bifurcations == (2, 0) and len(tracked(after).paths) == 2
    expect_others_as_before(field, after)
    changed = np.asarray(after.values) != np.asarray(field.values)
    assert not changed[0].any() and not changed[-1].any()
    assert not changed[:, surface.vertices[:, 1] > 0.45].any()


def test_a_bifurcation_is_removed_with_paths_that_live_to_the_end(surface):
    field = over_lambda(surface, birth)
    after, report = done(field, {"type": "remove_bifurcation", **named(event_of(field, "creation")), "reach": 0.1})
    assert report.status == "applied", report.reason
    assert tracked(after).bifurcations == [] and len(tracked(after).paths) == 2
    expect_others_as_before(field, after)


def test_a_gap_is_closed(surface):
    field = over_lambda(surface, gap)
    first, second = event_of(field, "annihilation"), event_of(field, "creation")
    assert first.lam < second.lam
    edit = {"type": "remove_bifurcation", **named(first), "until": named(second), "reach": 0.1}
    after, report = done(field, edit)
    assert report.status == "applied", report.reason
    assert tracked(after).bifurcations == []
    assert [path.life for path in tracked(after).paths] == [1.0] * 4
    expect_others_as_before(field, after)


@pytest.mark.parametrize("to_lam", [0.39, 0.61])
def test_a_bifurcation_is_moved_in_lambda(surface, to_lam):
    field = over_lambda(surface, birth)
    event = event_of(field, "creation")
    after, report = done(field, {"type": "move_bifurcation", **named(event), "to_lam": to_lam, "reach": 0.2})
    assert report.status == "applied", report.reason
    (moved,) = tracked(after).bifurcations
    assert moved.kind == "creation" and moved.node == event.node
    assert abs(moved.lam - to_lam) <= 0.5 / 20
    assert np.linalg.norm(moved.position - event.position) <= 0.5 * surface.mean_edge_length
    expect_others_as_before(field, after)
    outside = np.abs(np.asarray(field.lambdas) - 0.5) > 0.35
    np.testing.assert_array_equal(np.asarray(after.values)[outside], np.asarray(field.values)[outside])


def test_a_bifurcation_is_moved_in_space(surface):
    field = over_lambda(surface, birth)
    event = event_of(field, "creation")
    target = np.asarray(event.position) + np.array([0.08, -0.06, 0.0])
    after, report = done(field, {"type": "move_bifurcation", **named(event), "to": target.tolist(), "reach": 0.2})
    assert report.status == "applied", report.reason
    (moved,) = tracked(after).bifurcations
    assert np.linalg.norm(moved.position - target) <= 0.5 * surface.mean_edge_length
    assert abs(moved.lam - event.lam) <= 0.5 / 20
    expect_others_as_before(field, after)


def expect_refused(field, edit, why):
    after, report = done(field, edit)
    assert report.status == "refused"
    assert why in report.reason, report.reason
    np.testing.assert_array_equal(after.values, field.values)


def test_what_ends_with_another_partner_is_refused_by_its_name(surface):
    field = hysteresis(surface)
    edit = {"type": "remove_bifurcation", **named(event_of(field, "creation"))}
    expect_refused(field, edit, "ends with another partner, in the annihilation of a sink and a saddle at λ =")


def test_bad_input_of_bifurcations_is_refused_with_numbers(surface):
    field = over_lambda(surface, birth)
    event = named(event_of(field, "creation"))
    move = {"type": "move_bifurcation", **event, "to_lam": 0.6}
    expect_refused(field, {**move, "reach": 0.6}, "the reach goes beyond λ: from -0.0")
    expect_refused(field, {**move, "at": [0.9, 0.9, 0.0]}, "there is no bifurcation near (0.9, 0.9, 0) at λ =")
    expect_refused(field, {**move, "lam": 0.9}, "the nearest is the creation of a sink and a saddle at λ = 0.5")
    remove = {"type": "remove_bifurcation", **event}
    expect_refused(field, {**remove, "until": {**event}}, "are no gap")
    still = over_lambda(surface, lambda lam: 0.09)
    expect_refused(still, remove, "fixed points neither appear nor vanish in pairs")
    single = native.ParameterizedField(surface, np.zeros(1), np.asarray(field.values)[:1])
    expect_refused(single, remove, "fewer than three samples")


@pytest.mark.parametrize(
    ("edit", "fault"),
    [
        ({"type": "remove_bifurcation", "lam": 0.5}, "remove_bifurcation needs at"),
        ({"type": "remove_bifurcation", "at": [0, 0, 0]}, "remove_bifurcation needs lam"),
        ({"type": "move_bifurcation", "at": [0, 0, 0], "lam": 0.5}, "needs to or to_lam"),
        ({"type": "move_bifurcation", "at": [0, 0, 0], "lam": [0.1, 0.5], "to_lam": 0.4}, "acts at one λ"),
        ({"type": "move_bifurcation", "at": [0, 0, 0], "lam": 0.5, "to_lam": 2}, "give at most 1"),
        ({"type": "remove_bifurcation", "at": [0, float("nan"), 0], "lam": 0.5}, "not finite"),
        ({"type": "remove_bifurcation", "at": [0, 0, 0], "lam": 0.5, "keep": 3}, "keep does not belong to"),
    ],
)
def test_edits_of_bifurcations_that_say_too_little_are_refused(edit, fault):
    with pytest.raises(InputError) as caught:
        edits_from_json({"schema": "stormfield.edits/1", "edits": [edit]})
    assert fault in str(caught.value)
