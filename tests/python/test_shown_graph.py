# SPDX-License-Identifier: GPL-3.0-or-later
"""What stays of a graph when some of its entities are hidden."""

import numpy as np
from stormfield.analysis.entities import Entity, EntityGraph, Link
from stormfield.analysis.shown_graph import shown_graph

KINDS = {"R": ("source", "repelling"), "S": ("saddle", "saddle"), "A": ("sink", "attracting")}
KINDS |= {"r": ("repelling", "repelling"), "a": ("attracting", "attracting")}


def graph(names, *links):
    entities = tuple(Entity(i, name, *KINDS[name[0]], np.zeros(3)) for i, name in enumerate(names))
    number = {name: i for i, name in enumerate(names)}
    return EntityGraph("test", entities, tuple(Link(number[a], number[b]) for a, b in links), 0.5)


def shown(whole, *names):
    part = shown_graph(whole, [entity.id for entity in whole.entities if entity.name in names])
    assert [entity.id for entity in part.entities] == list(range(len(part.entities)))
    assert {entity.name for entity in part.entities} == set(names)
    names_of = [entity.name for entity in part.entities]
    return sorted((names_of[link.source], names_of[link.target]) for link in part.links)


def test_all_of_a_graph_is_the_graph():
    whole = graph(["R1", "S1", "A1"], ("R1", "S1"), ("S1", "A1"), ("R1", "A1"))
    assert shown(whole, "R1", "S1", "A1") == [("R1", "A1"), ("R1", "S1"), ("S1", "A1")]


def test_faint_orbits_count_as_the_storm_that_they_turn_around():
    """The saddle's streamlines end at the outer orbit of the nest: one storm for the artist."""
    nest = [("R1", "a1"), ("r1", "a1"), ("r1", "a2"), ("S1", "a2")]
    whole = graph(["R1", "a1", "r1", "a2", "S1", "A9"], *nest, ("S1", "A9"))
    assert shown(whole, "R1", "S1", "A9") == [("S1", "A9"), ("S1", "R1")]


def test_two_links_to_one_storm_are_one():
    whole = graph(["A1", "r1", "a1", "S1"], ("r1", "A1"), ("r1", "a1"), ("S1", "a1"), ("S1", "A1"))
    assert shown(whole, "A1", "S1") == [("S1", "A1")]


def test_hidden_ones_between_two_storms_belong_to_neither():
    whole = graph(["R1", "a1", "R2", "S1"], ("R1", "a1"), ("R2", "a1"), ("S1", "a1"))
    assert shown(whole, "R1", "R2", "S1") == []


def test_nothing_shown_is_an_empty_graph():
    assert shown(graph(["R1", "A1"], ("R1", "A1"))) == []
