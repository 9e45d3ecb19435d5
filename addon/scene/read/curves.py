# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as polylines: every kind of object an artist may draw with, in the space of the field's mesh.

Blender itself evaluates Bezier, NURBS and modifiers; here only its points are put in order.
"""

from collections.abc import Iterable, Iterator

import bpy
import numpy as np
from mathutils import Matrix


def read_polylines(source: bpy.types.Object, depsgraph: bpy.types.Depsgraph, to_mesh: Matrix) -> list[np.ndarray]:
    """One (n, 3) float64 array per spline, stroke or chain of edges; `to_mesh` takes world space to the mesh's."""
    evaluated = source.evaluated_get(depsgraph)
    matrix = np.array(to_mesh @ evaluated.matrix_world)
    readers = {
        "CURVE": _legacy_curve, "FONT": _legacy_curve, "CURVES": _hair_curves, "MESH": _mesh_edges,
        "GREASEPENCIL": _grease_pencil,
    }  # fmt: skip
    lines = (np.asarray(line, dtype=np.float64) for line in readers[source.type](evaluated, depsgraph))
    return [line @ matrix[:3, :3].T + matrix[:3, 3] for line in lines if len(line) > 0]


def take_over_edits(sources: Iterable[bpy.types.Object]) -> None:
    """Bring what was drawn in Edit Mode, which is still on, into the data that is evaluated."""
    for source in sources:
        if source.mode == "EDIT":
            source.update_from_editmode()


def _legacy_curve(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[np.ndarray]:
    """A bevelled curve would become a tube, so a bare copy of its evaluated data is turned into edges."""
    bare = evaluated.to_curve(depsgraph, apply_modifiers=True).copy()
    evaluated.to_curve_clear()
    bare.bevel_mode, bare.bevel_depth, bare.extrude, bare.offset = "ROUND", 0.0, 0.0, 0.0
    bare.dimensions, bare.fill_mode = "3D", "FULL"
    holder = bpy.data.objects.new("stormfield_polyline", bare)
    try:
        mesh = holder.to_mesh()  # None for a curve without points
        return list(chains(*_edges(mesh))) if mesh else []
    finally:
        holder.to_mesh_clear()
        bpy.data.objects.remove(holder)
        bpy.data.curves.remove(bare)


def _mesh_edges(evaluated: bpy.types.Object, _depsgraph: bpy.types.Depsgraph) -> list[np.ndarray]:
    return list(chains(*_edges(evaluated.data)))


def _hair_curves(evaluated: bpy.types.Object, _depsgraph: bpy.types.Depsgraph) -> list[np.ndarray]:
    curves = evaluated.data
    points = np.empty(len(curves.points) * 3, dtype=np.float32)
    curves.attributes["position"].data.foreach_get("vector", points)
    offsets = np.empty(len(curves.curves) + 1, dtype=np.int32)
    curves.curve_offset_data.foreach_get("value", offsets)
    return np.split(points.reshape(-1, 3), offsets[1:-1])


def _grease_pencil(evaluated: bpy.types.Object, _depsgraph: bpy.types.Depsgraph) -> list[np.ndarray]:
    """Strokes of the visible layers at the current frame, each layer with its own transform."""
    lines = []
    for layer in evaluated.data.layers:
        frame = None if layer.hide else layer.current_frame()
        matrix = np.array(layer.matrix_local)
        for stroke in frame.drawing.strokes if frame else ():
            points = np.array([point.position for point in stroke.points])
            lines.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    return lines


def _edges(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    edges = np.empty(len(mesh.edges) * 2, dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges)
    return points.reshape(-1, 3), edges.reshape(-1, 2)


def chains(points: np.ndarray, edges: np.ndarray) -> Iterator[np.ndarray]:
    """The edges as chains: open ones from their first end, closed ones back to their first vertex."""
    neighbours: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    left = {tuple(sorted(edge)) for edge in edges.tolist()}
    ends = [vertex for vertex in sorted(neighbours) if len(neighbours[vertex]) != 2]
    for start in ends + sorted(neighbours):
        while True:
            chain = [start]
            while True:
                here = chain[-1]
                free = [v for v in neighbours[here] if tuple(sorted((here, v))) in left]
                if not free or (len(chain) > 1 and len(neighbours[here]) != 2):
                    break
                left.remove(tuple(sorted((here, free[0]))))
                chain.append(free[0])
            if len(chain) < 2:
                break
            yield points[chain]
