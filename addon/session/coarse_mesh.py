# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a mesh is too coarse for its elements, before it is solved. Measured once for each mesh, so that panels may
ask at every redraw."""

import bpy
import numpy as np

_means: dict[int, tuple[tuple[int, ...], float]] = {}  #: by the mesh's session uid: its counts, and its mean edge


def why_too_coarse(obj: bpy.types.Object) -> str:
    """The enabled singular element whose radius is below the mean edge, and the cures; empty where there is none."""
    edge = mean_edge(obj.data)
    solve = obj.stormfield.solve
    if solve.solve_on == "DENSITY":
        edge = min(edge, solve.edge)
    storms = [element for element in obj.stormfield.elements if element.enabled and element.type == "singular"]
    small = [element for element in storms if element.radius < edge]
    if not small:
        return ""
    least = min(small, key=lambda element: element.radius)
    more = f" and {len(small) - 1} more" if len(small) > 1 else ""
    return (
        f"'{least.name}'{more}: radius {least.radius:.2g}, below the mesh's edges of {edge:.2g}. Subdivide the mesh, "
        "or make the radius larger"
    )


def mean_edge(mesh: bpy.types.Mesh) -> float:
    """Mean length of the edges, mesh units; 0 without any."""
    counts = (len(mesh.vertices), len(mesh.edges))
    known = _means.get(mesh.session_uid)
    if known is None or known[0] != counts:
        _means[mesh.session_uid] = known = (counts, _measured(mesh))
    return known[1]


def forget() -> None:
    _means.clear()


def _measured(mesh: bpy.types.Mesh) -> float:
    if not len(mesh.edges):
        return 0.0
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    ends = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", ends)
    places = points.reshape(-1, 3)[ends.reshape(-1, 2)]
    return float(np.linalg.norm(places[:, 1] - places[:, 0], axis=1).mean())
