# SPDX-License-Identifier: GPL-3.0-or-later
"""The field that edits are tested on (the fixture pair), and how its entities are selected."""

from collections import Counter

import bpy
import numpy as np

#: Two sources and a sink: their indices ask for one saddle between the sources.
ELEMENTS = (("source", (0, 0, 1)), ("sink", (0, 0, -1)), ("source", (1, 0, 0)))
AS_SOLVED = {"source": 2, "saddle": 1, "sink": 1}
CANCELLED = {"source": 1, "sink": 1}


def kinds(obj):
    return dict(Counter(item.kind for item in obj.stormfield.analysis.ecg.items))


def select(obj, *wanted):
    """Select entities in the graph by kind and nearest place; the first is that of the list."""
    from stormfield.scene.write import selection

    ecg = obj.stormfield.analysis.ecg
    chosen = [
        min(
            (i for i, item in enumerate(ecg.items) if item.kind == kind),
            key=lambda i, place=place: np.linalg.norm(np.array(ecg.items[i].position) - place),
        )
        for kind, place in wanted
    ]
    selection.select(obj, "ecg", chosen[0])
    for node in obj.stormfield.analysis.ecg_tree.nodes:
        node.select = node.entity in chosen


def vectors(obj):
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.attributes["sf_advection"].data.foreach_get("vector", values)
    return values.tobytes()


SADDLE, NORTH, SOUTH, EAST = (
    ("saddle", (0.6, 0, 0.8)),
    ("source", (0, 0, 1)),
    ("sink", (0, 0, -1)),
    ("source", (1, 0, 0)),
)
