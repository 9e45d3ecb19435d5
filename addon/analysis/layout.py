# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an entity graph's nodes go: three rows (thesis 3.2), ordered so that few links cross (Sugiyama, by igraph).

    drawn = layout(graph)
    drawn.positions[entity.id], drawn.routes[i]      # x to the right, y up: neighbours are at least 1 apart
    crossings(drawn.positions, graph.links)          # of straight links

Repelling entities are in the row y = 2, saddles at 1, attracting ones at 0. A link that passes the saddles' row bends
there, in a gap between the nodes. The same graph gives the same picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .entities import EntityGraph, Link

#: Height of each row.
ROWS = {"attracting": 0, "saddle": 1, "repelling": 2}
#: Sweeps over the rows; they end earlier when the order does not change any more.
SWEEPS = 200


@dataclass(frozen=True, eq=False)
class GraphLayout:
    positions: np.ndarray  #: (n, 2) of each entity
    routes: tuple[np.ndarray, ...]  #: per link (k, 2), from its source to its target, with the bends between

    @property
    def width(self) -> float:
        return float(np.ptp(self.positions[:, 0])) if len(self.positions) else 0.0


def layout(graph: EntityGraph) -> GraphLayout:
    """Positions and routes. Raises RuntimeError with the cure where igraph is missing."""
    try:
        import igraph
    except ImportError:
        raise RuntimeError("Graphs are laid out by igraph, which is missing: install it (pip install igraph)") from None
    count = len(graph.entities)
    if count == 0:
        return GraphLayout(np.zeros((0, 2)), ())
    height = np.array([ROWS[entity.row] for entity in graph.entities])
    down = [_downwards(link, height) for link in graph.links]  # None within a row
    pairs = {pair for pair in down if pair is not None}
    bend = {pair: count + i for i, pair in enumerate(sorted(p for p in pairs if height[p[0]] - height[p[1]] == 2))}
    steps = sorted(pairs - bend.keys()) + [step for (a, b), c in bend.items() for step in ((a, c), (c, b))]
    layers = [*(2 - height).tolist(), *(1 for _ in bend)]
    drawing = igraph.Graph(len(layers), steps, directed=True)
    order = _along(drawing)
    number = np.argsort(order)
    drawing = igraph.Graph(len(layers), [(int(number[a]), int(number[b])) for a, b in steps], directed=True)
    sugiyama = drawing.layout_sugiyama(layers=[layers[i] for i in order], hgap=1, vgap=1, maxiter=SWEEPS)
    places = np.empty(len(layers))
    places[order] = [x for x, _ in sugiyama.coords]
    _keep_apart(places, np.array(layers))
    places -= 0.5 * (places[:count].min() + places[:count].max())
    positions = np.column_stack([places[:count], height]).astype(np.float64)
    at = {pair: np.array([places[node], 1.0]) for pair, node in bend.items()}
    routes = tuple(
        _route(link, positions, at.get(pair) if pair else None) for link, pair in zip(graph.links, down, strict=True)
    )
    return GraphLayout(positions, routes)


def crossings(positions: np.ndarray, links: Sequence[Link]) -> int:
    """Pairs of links that cross when drawn straight; links that share an end, or lie in one row, do not count."""
    ends = np.array([(link.source, link.target) for link in links], np.int64).reshape(-1, 2)
    a, b = positions[ends[:, 0]], positions[ends[:, 1]]
    slanted = a[:, 1] != b[:, 1]
    ends, a, b = ends[slanted], a[slanted], b[slanted]
    first, second = np.triu_indices(len(ends), 1)
    apart = (ends[first, :, None] != ends[second, None, :]).all(axis=(1, 2))
    first, second = first[apart], second[apart]

    def side(p, q, r):
        return np.sign((q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0]))

    across = side(a[first], b[first], a[second]) * side(a[first], b[first], b[second])
    back = side(a[second], b[second], a[first]) * side(a[second], b[second], b[first])
    return int(((across < 0) & (back < 0)).sum())


def _downwards(link: Link, height: np.ndarray) -> tuple[int, int] | None:
    if height[link.source] == height[link.target]:
        return None
    return (link.source, link.target) if height[link.source] > height[link.target] else (link.target, link.source)


def _along(drawing) -> np.ndarray:
    """Node numbers by their distance from one end of the graph: where the sweeps begin decides where they end."""
    far = np.zeros(drawing.vcount())
    for component in drawing.connected_components(mode="weak"):
        start = component[0]
        for _ in range(3):
            away = drawing.distances(start, component, mode="all")[0]
            start = component[int(np.argmax(away))]
        far[component] = away
    return np.argsort(far, kind="stable")


def _keep_apart(places: np.ndarray, layers: np.ndarray) -> None:
    """Push neighbours of a row to a distance of 1: components of the graph without links between them may overlap."""
    for layer in np.unique(layers):
        row = np.flatnonzero(layers == layer)
        row = row[np.argsort(places[row], kind="stable")]
        steps = np.arange(len(row))
        places[row] = np.maximum.accumulate(places[row] - steps) + steps


def _route(link: Link, positions: np.ndarray, bend: np.ndarray | None) -> np.ndarray:
    """Straight, through its bend in the saddles' row, or over its own row in an arch."""
    start, end = positions[link.source], positions[link.target]
    if start[1] == end[1]:
        bend = 0.5 * (start + end) + (0.0, min(0.4, 0.12 * abs(end[0] - start[0])))
    return np.array([start, end] if bend is None else [start, bend, end])
