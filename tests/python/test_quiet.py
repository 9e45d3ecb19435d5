# SPDX-License-Identifier: GPL-3.0-or-later
"""What is weaker than the accuracy of a solve, what is a storm, and which elements' names fixed points carry."""

import numpy as np
import pytest
from stormfield.analysis import quiet
from stormfield.analysis.entities import Entity, EntityGraph
from stormfield.analysis.naming import ElementPlace, named_graph, named_tracking
from stormfield.analysis.tracking import Bifurcation, TrackedPath, Tracking


def path(number, kind, index, lam, places, rotation=2.0, strength=1.0):
    times = np.linspace(*lam, 21)
    positions = np.linspace(*np.array(places, float), 21)
    name = f"{kind[0].upper()}{number + 1}"
    return TrackedPath(
        number, name, kind, index, times, positions, np.zeros(21, np.int32), np.full((21, 3), 1 / 3),
        (kind,) * 21, "first", "last", strength, rotation,
    )  # fmt: skip


@pytest.fixture
def merge():
    """Two storms come together at λ 0.6; the saddle between them takes one away."""
    paths = (
        path(0, "source", 1, (0.0, 1.0), ((-1, 0, 0), (0.2, 0, 0))),
        path(1, "sink", 1, (0.0, 0.6), ((1, 0, 0), (0, 0, 0))),
        path(2, "saddle", -1, (0.0, 0.6), ((0, 0, 0), (0, 0, 0)), rotation=0.0),
        path(3, "sink", 1, (0.0, 0.3), ((5, 0, 0), (5, 1, 0)), rotation=0.1),
        path(4, "saddle", -1, (0.0, 0.3), ((6, 0, 0), (5, 1, 0)), rotation=0.0),
        path(5, "sink", 1, (0.5, 0.505), ((3, 0, 0), (3, 0, 0)), strength=0.1),
    )
    place = np.zeros(3)
    events = (
        Bifurcation(0, 0.3, place, "annihilation", "sink", (3, 4)),
        Bifurcation(1, 0.6, place, "annihilation", "sink", (1, 2)),
        Bifurcation(2, 0.5, place, "creation", "sink", (5, 2)),
        Bifurcation(3, 0.2, place, "hopf", "sink", (0,)),
    )
    return Tracking(paths, events)


def test_two_storms_merge_and_nothing_else_does(merge):
    assert [quiet.storm_event(event, merge) for event in merge.bifurcations] == ["", "storms merge", "", ""]


def test_storms_that_turn_against_each_other_do_not_merge(merge):
    other = path(0, "source", 1, (0.0, 1.0), ((-1, 0, 0), (0.2, 0, 0)), rotation=-2.0)
    against = Tracking((other, *merge.paths[1:]), merge.bifurcations)
    assert quiet.storm_event(merge.bifurcations[1], against) == ""


def test_backwards_it_is_a_split():
    paths = (
        path(0, "source", 1, (0.0, 1.0), ((0.2, 0, 0), (-1, 0, 0))),
        path(1, "sink", 1, (0.4, 1.0), ((0, 0, 0), (1, 0, 0))),
        path(2, "saddle", -1, (0.4, 1.0), ((0, 0, 0), (0, 0, 0)), rotation=0.0),
    )
    event = Bifurcation(0, 0.4, np.zeros(3), "creation", "sink", (1, 2))
    assert quiet.storm_event(event, Tracking(paths, (event,))) == "storm splits"


def test_weights_tell_weak_from_strong(merge):
    strong, weak = merge.paths[0], merge.paths[5]
    assert quiet.path_weight(strong, 1.0) > 10 and quiet.path_weight(weak, 1.0) < 1
    events = merge.bifurcations
    assert quiet.event_weight(events[1], merge.paths, 1.0) > 1 > quiet.event_weight(events[2], merge.paths, 1.0)
    assert quiet.event_weight(Bifurcation(0, 0.1, np.zeros(3), "hopf", "sink", ()), (), 1.0) == quiet.ALWAYS
    assert quiet.orbit_weight(1.0) == 0 and quiet.orbit_weight(1.02) < 1 < quiet.orbit_weight(3.0)
    assert quiet.orbit_weight(1 / 3.0) == pytest.approx(quiet.orbit_weight(3.0))


@pytest.mark.parametrize(
    ("jacobian", "storm"),
    [
        ([[0.0, -1.0], [1.0, 0.0]], True),
        ([[0.1, -1.0], [1.0, 0.1]], True),
        ([[1.0, -1.0], [1.0, 1.0]], False),
        ([[1.0, 0.0], [0.0, 1.0]], False),
        ([[1.0, -3.0], [-3.0, -1.0]], False),
    ],
)
def test_a_storm_turns_more_than_it_flows_out(jacobian, storm):
    assert quiet.is_storm(np.array(jacobian)) == storm


@pytest.fixture
def places():
    return [
        ElementPlace("West", 0.2, np.array([0.0, 0.6]), np.array([[-1.0, 0, 0], [-0.28, 0, 0]]), (0.0, 0.6)),
        ElementPlace("East", 0.2, np.array([0.0, 0.6]), np.array([[1.0, 0, 0], [0.0, 0, 0]]), (0.0, 0.6)),
        ElementPlace("One", 0.2, np.array([0.6, 1.0]), np.array([[-0.28, 0, 0], [0.2, 0, 0]]), (0.6, 1.0)),
    ]


def test_paths_carry_the_names_of_the_elements_they_follow(merge, places):
    names = [each.name for each in named_tracking(merge, places).paths]
    assert names[:2] == ["West → One", "East"] and names[2:5] == ["S3", "S4", "S5"]
    assert named_tracking(merge, []).paths[0].name == "S1"


def test_points_of_a_graph_carry_the_name_of_the_nearest_element(places):
    points = tuple(
        Entity(i, f"X{i}", "source", "repelling", np.array(place, float))
        for i, place in enumerate([(-0.95, 0, 0), (-0.9, 0, 0), (0.95, 0.1, 0), (0, 1, 0)])
    )
    graph = EntityGraph("", points, (), 0.03)
    assert [entity.name for entity in named_graph(graph, places).entities] == ["West", "X1", "East", "X3"]
    late = EntityGraph("", points, (), 0.9)
    assert [entity.name for entity in named_graph(late, places).entities] == ["X0", "X1", "X2", "X3"]


def test_names_stay_unique_and_short():
    points = tuple(
        Entity(i, name, "source", "repelling", np.array([float(i), 0, 0])) for i, name in enumerate(("R1", "R2", "S1"))
    )
    here = [(0.0, 0, 0), (1.0, 0, 0)]
    places = [ElementPlace("S1", 0.2, np.array([0.0]), np.array([place]), (0.0, 1.0)) for place in here]
    long = ElementPlace("x" * 80, 0.2, np.array([0.0]), np.array([[2.0, 0, 0]]), (0.0, 1.0))
    names = [entity.name for entity in named_graph(EntityGraph("", points, (), 0.5), places).entities]
    assert names == ["S1 (2)", "S1 (3)", "S1"]
    names = [entity.name for entity in named_graph(EntityGraph("", points, (), 0.5), [long]).entities]
    assert names[:2] == ["R1", "R2"] and names[2] == "x" * 54
    wide = ElementPlace("嵐" * 30, 0.2, np.array([0.0]), np.array([[2.0, 0, 0]]), (0.0, 1.0))
    name = named_graph(EntityGraph("", points, (), 0.5), [wide]).entities[2].name
    assert name == "嵐" * 18 and len(name.encode()) == 54
