# SPDX-License-Identifier: GPL-3.0-or-later
"""The three-row layout of entity graphs: rows, order, speed."""

import time

import numpy as np
import pytest

pytest.importorskip("igraph", reason="igraph is not installed")

from stormfield.analysis.entities import Entity, EntityGraph, Link
from stormfield.analysis.layout import ROWS, crossings, layout

NAMES = ("repelling", "saddle", "attracting")
KINDS = {"repelling": "source", "saddle": "saddle", "attracting": "sink"}


def graph_of(rows, links):
    entities = tuple(
        Entity(id=i, name=f"{row[0].upper()}{i}", kind=KINDS[row], row=row, position=np.zeros(3))
        for i, row in enumerate(rows)
    )
    return EntityGraph("Entity connection graph", entities, tuple(Link(a, b) for a, b in links), 0.0)


def planar_graph(count, seed=0):
    """A field on a strip: saddles between neighbours, as drawn without any crossing; then its nodes are shuffled."""
    random = np.random.default_rng(seed)
    rows = ["repelling"] * count + ["saddle"] * count + ["attracting"] * count
    links = []
    for i in range(count):
        links += [(i, count + i), (count + i, 2 * count + i)]
        if i + 1 < count:
            links += [(i + 1, count + i), (count + i, 2 * count + i + 1)]
    order = random.permutation(len(rows))
    place = np.argsort(order)
    return graph_of([rows[i] for i in order], [(int(place[a]), int(place[b])) for a, b in links])


def random_graph(count, seed=0):
    random = np.random.default_rng(seed)
    rows = [NAMES[i % 3] for i in range(count)]
    by_row = {name: [i for i, row in enumerate(rows) if row == name] for name in NAMES}
    links = set()
    for saddle in by_row["saddle"]:
        links |= {(int(random.choice(by_row["repelling"])), saddle) for _ in range(2)}
        links |= {(saddle, int(random.choice(by_row["attracting"]))) for _ in range(2)}
    for _ in range(count // 10):
        links.add((int(random.choice(by_row["repelling"])), int(random.choice(by_row["attracting"]))))
    return graph_of(rows, sorted(links))


def input_order(graph):
    """Every row in the order of the entities."""
    seen = dict.fromkeys(NAMES, 0)
    positions = []
    for entity in graph.entities:
        positions.append((seen[entity.row], ROWS[entity.row]))
        seen[entity.row] += 1
    return np.array(positions, float)


@pytest.mark.parametrize("graph", [planar_graph(12), random_graph(60), random_graph(300)])
def test_rows_are_kept_and_nodes_do_not_touch(graph):
    drawn = layout(graph)
    assert [int(y) for y in drawn.positions[:, 1]] == [ROWS[entity.row] for entity in graph.entities]
    for y in range(3):
        x = np.sort(drawn.positions[drawn.positions[:, 1] == y, 0])
        assert (np.diff(x) >= 1 - 1e-9).all()


@pytest.mark.parametrize("seed", range(4))
def test_fewer_links_cross_than_in_the_order_of_the_input(seed):
    graph = random_graph(90, seed)
    assert crossings(layout(graph).positions, graph.links) < 0.4 * crossings(input_order(graph), graph.links)


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_of_saddles_is_untangled(seed):
    graph = planar_graph(10, seed)
    before, after = crossings(input_order(graph), graph.links), crossings(layout(graph).positions, graph.links)
    assert before > 100 and after == 0


def test_routes_lead_from_source_to_target_and_bend_between_the_saddles():
    graph = graph_of(["repelling", "saddle", "attracting", "attracting", "saddle"], [(0, 1), (1, 2), (0, 3), (1, 4)])
    drawn = layout(graph)
    for link, route in zip(graph.links, drawn.routes, strict=True):
        assert np.array_equal(route[0], drawn.positions[link.source])
        assert np.array_equal(route[-1], drawn.positions[link.target])
    assert [len(route) for route in drawn.routes] == [2, 2, 3, 3]
    bend = drawn.routes[2][1]
    assert bend[1] == 1.0 and abs(bend[0] - drawn.positions[1, 0]) >= 1 - 1e-9


def test_links_against_the_rows_and_to_oneself_do_no_harm():
    drawn = layout(graph_of(["repelling", "saddle", "attracting"], [(2, 1), (1, 0), (2, 0), (1, 1)]))
    assert [len(route) for route in drawn.routes] == [2, 2, 3, 3]
    assert np.array_equal(drawn.routes[2][0], drawn.positions[2])


def test_nothing_and_lonely_entities():
    assert layout(graph_of([], [])).positions.shape == (0, 2)
    drawn = layout(graph_of(["saddle", "saddle", "repelling"], []))
    assert abs(drawn.positions[0, 0] - drawn.positions[1, 0]) >= 1 - 1e-9


def test_parts_without_links_between_them_do_not_overlap():
    rows = ["repelling"] * 3 + ["saddle"] * 9 + ["attracting"] * 2
    links = [(0, 3), (0, 5), (0, 7), (0, 11), (1, 3), (1, 5), (2, 11), (2, 13), (5, 13), (7, 12), (8, 12), (9, 12)]
    drawn = layout(graph_of(rows, links))
    for y in range(3):
        x = np.sort(drawn.positions[drawn.positions[:, 1] == y, 0])
        assert (np.diff(x) >= 1 - 1e-9).all()


def test_the_same_graph_gives_the_same_picture():
    graph = random_graph(90)
    assert np.array_equal(layout(graph).positions, layout(graph).positions)


def test_crossings_are_counted():
    positions = np.array([[0, 1], [1, 1], [0, 0], [1, 0]], float)
    assert crossings(positions, [Link(0, 3), Link(1, 2)]) == 1
    assert crossings(positions, [Link(0, 2), Link(1, 3)]) == 0
    assert crossings(positions, [Link(0, 2), Link(0, 3)]) == 0
    assert crossings(positions, []) == 0


def test_three_hundred_entities_take_less_than_a_second_of_work():
    graph = random_graph(300)
    layout(random_graph(9))  # the library is loaded
    start = time.process_time()
    layout(graph)
    assert time.process_time() - start < 1.0
