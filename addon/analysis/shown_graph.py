# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of an entity graph that is shown, when filters or the accuracy of the solve hide the rest."""

from collections.abc import Collection
from dataclasses import replace

from .entities import EntityGraph, Link


def shown_graph(graph: EntityGraph, shown: Collection[int]) -> EntityGraph:
    """The shown entities, numbered anew in the same order, and the links between them.

    Hidden orbits around one fixed point count as that point: what is linked to them is linked to it, so that a saddle
    whose streamlines end at a faint orbit around a storm is linked to the storm. Other hidden ones go with their links.
    """
    stands_for = {entity: entity for entity in shown}
    for group in _hidden_groups(graph, shown):
        beside = {end for link in graph.links if group & set(_ends(link)) for end in _ends(link)}
        centres = [entity for entity in beside & set(shown) if graph.entities[entity].row != "saddle"]
        if len(centres) == 1:
            stands_for |= dict.fromkeys(group, centres[0])
    number = {entity: place for place, entity in enumerate(sorted(shown))}
    links: dict[tuple[int, int], Link] = {}
    for link in graph.links:
        ends = stands_for.get(link.source), stands_for.get(link.target)
        if ends[0] is not None and ends[1] is not None and ends[0] != ends[1]:
            pair = number[ends[0]], number[ends[1]]
            known = links.get(pair, Link(*pair))
            links[pair] = replace(known, curves=known.curves + link.curves)
    entities = tuple(replace(graph.entities[entity], id=place) for entity, place in number.items())
    return replace(graph, entities=entities, links=tuple(links.values()))


def _ends(link: Link) -> tuple[int, int]:
    return link.source, link.target


def _hidden_groups(graph: EntityGraph, shown: Collection[int]) -> list[set[int]]:
    """Hidden entities that links join."""
    left = {entity.id for entity in graph.entities} - set(shown)
    joined: dict[int, set[int]] = {entity: set() for entity in left}
    for link in graph.links:
        if link.source in left and link.target in left:
            joined[link.source].add(link.target)
            joined[link.target].add(link.source)
    groups = []
    while left:
        group, ahead = set(), [left.pop()]
        while ahead:
            entity = ahead.pop()
            group.add(entity)
            ahead += [other for other in joined[entity] if other not in group]
        left -= group
        groups.append(group)
    return groups
