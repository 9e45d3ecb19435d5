# SPDX-License-Identifier: GPL-3.0-or-later
"""Vector attributes of an object's own mesh as vectors at its vertices: of points, faces or corners; still, or as the
modifiers make them at a frame.

Where modifiers move the surface, the vectors lie on the surface that is seen. They are brought back to the mesh at rest
face by face, with the same share along each edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...model.errors import InputError
from .mesh import loop_triangles

#: Types of attributes that hold a vector, and the property and the count of their numbers.
VECTORS = {
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT2": ("vector", 2),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
DOMAINS = ("POINT", "FACE", "CORNER")
#: Attributes that are no field: Blender's own, and ours.
NO_FIELD = ("position", ".", "sf_", "custom_normal", "rest_position", "sharp_")
#: Last letters of three attributes of numbers that are one vector, as importers of PLY leave them.
TRIPLES = (("x", "y", "z"), ("X", "Y", "Z"), ("0", "1", "2"), ("1", "2", "3"))


@dataclass(frozen=True)
class Candidate:
    """name: of one attribute, or of three with commas between. domain: POINT, FACE or CORNER."""

    name: str
    domain: str

    @property
    def words(self) -> str:
        return f"{self.name} ({self.domain.lower()})"


def candidates(mesh: bpy.types.Mesh) -> list[Candidate]:
    """The attributes of a mesh that may be a field, vectors before colours and UV maps."""
    found = [attribute for attribute in mesh.attributes if _may_be(attribute)]
    kinds = ("FLOAT_VECTOR", "FLOAT", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR")
    numbers = {a.name: a.domain for a in found if a.data_type == "FLOAT"}
    single = [a for a in found if a.data_type in VECTORS]
    ordered = sorted(single, key=lambda attribute: kinds.index(attribute.data_type))
    vectors = [Candidate(a.name, a.domain) for a in ordered if a.data_type == "FLOAT_VECTOR"]
    rest = [Candidate(a.name, a.domain) for a in ordered if a.data_type != "FLOAT_VECTOR"]
    return [*vectors, *_triples(numbers), *rest]


def read_vectors(mesh: bpy.types.Mesh, name: str, where: str) -> np.ndarray:
    """(n, 3) float64 at the vertices of an evaluated or own mesh: those of faces and corners averaged by area. Raises
    InputError."""
    columns: list[np.ndarray] = []
    domain = ""
    for part in names_of(mesh, name):
        attribute = mesh.attributes.get(part)
        if attribute is None:
            listed = ", ".join(candidate.words for candidate in candidates(mesh)) or "none"
            raise InputError(f"{where} has no attribute '{part}'; choose from: {listed}")
        if attribute.domain not in DOMAINS or (domain and attribute.domain != domain):
            raise InputError(f"'{part}' of {where} is on {attribute.domain.lower()}s; give points, faces or corners")
        domain = attribute.domain
        columns.append(_numbers(attribute, where))
    values = np.concatenate(columns, axis=1)[:, :3]
    if values.shape[1] == 2:
        values = np.column_stack([values, np.zeros(len(values))])
    if values.shape[1] != 3:
        raise InputError(f"'{name}' of {where} has {values.shape[1]} numbers; name a vector of 3, or three of one")
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(bad):
        raise InputError(f"'{name}' of {where} is not finite at {domain.lower()} {bad[0]} and {len(bad) - 1} others")
    return values if domain == "POINT" else _at_vertices(mesh, values, domain)


def names_of(mesh: bpy.types.Mesh, name: str) -> list[str]:
    """One name, which may hold commas, or those between the commas."""
    return [name] if name in mesh.attributes else [part.strip() for part in name.split(",")]


def at_rest(own: bpy.types.Mesh, seen: bpy.types.Mesh, vectors: np.ndarray, where: str) -> np.ndarray:
    """Vectors on the surface that is seen, on the mesh at rest. Raises InputError where modifiers change the mesh."""
    if len(own.vertices) != len(seen.vertices) or len(own.polygons) != len(seen.polygons):
        raise InputError(
            f"modifiers change the mesh of {where} from {len(own.vertices)} to {len(seen.vertices)} vertices; "
            "apply them, or switch off those that do"
        )
    rest, moved = _positions(own), _positions(seen)
    size = float(np.ptp(rest, axis=0).max()) or 1.0
    if np.abs(rest - moved).max() < 1e-6 * size:
        return vectors
    triangles, _ = loop_triangles(own)
    shares, area = _along_edges(moved[triangles], vectors[triangles])
    edges = rest[triangles[:, 1:]] - rest[triangles[:, :1]]
    on_faces = np.einsum("fce,fek->fck", shares, edges)
    return _mean(triangles.ravel(), on_faces.reshape(-1, 3), np.repeat(area, 3), len(rest))


def _along_edges(corners: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The shares of vectors (f, 3, 3) along the first two edges of their triangles (f, 3, 2), and the areas."""
    edges = corners[:, 1:] - corners[:, :1]
    gram = np.einsum("fik,fjk->fij", edges, edges)
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    gram[area == 0.0] = np.eye(2)
    parts = np.einsum("fck,fek->fce", vectors, edges)
    return np.einsum("fce,fed->fcd", parts, np.linalg.inv(gram)), area


def _at_vertices(mesh: bpy.types.Mesh, values: np.ndarray, domain: str) -> np.ndarray:
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    counts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    areas = np.empty(len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("area", areas)
    at_corners = values if domain == "CORNER" else np.repeat(values, counts, axis=0)
    return _mean(corners, at_corners, np.repeat(areas / counts, counts), len(mesh.vertices))


def _mean(places: np.ndarray, values: np.ndarray, weights: np.ndarray, count: int) -> np.ndarray:
    weights = weights.astype(np.float64)
    total = np.bincount(places, weights, count)
    sums = np.column_stack([np.bincount(places, weights * values[:, k], count) for k in range(3)])
    return np.divide(sums, total[:, None], out=np.zeros_like(sums), where=total[:, None] > 0.0)


def _positions(mesh: bpy.types.Mesh) -> np.ndarray:
    values = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(np.float64)


def _numbers(attribute: bpy.types.Attribute, where: str) -> np.ndarray:
    if attribute.data_type == "FLOAT":
        name, width = "value", 1
    elif attribute.data_type in VECTORS:
        name, width = VECTORS[attribute.data_type]
    else:
        raise InputError(f"'{attribute.name}' of {where} holds no vectors; choose another")
    values = np.empty(len(attribute.data) * width, np.float32)
    attribute.data.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float64)


def _may_be(attribute: bpy.types.Attribute) -> bool:
    return (
        attribute.domain in DOMAINS
        and (attribute.data_type in VECTORS or attribute.data_type == "FLOAT")
        and not attribute.name.startswith(NO_FIELD)
        and not (attribute.data_type == "FLOAT2" and attribute.domain == "CORNER")  # a UV map
    )


def _triples(numbers: dict[str, str]) -> list[Candidate]:
    found = []
    for name, domain in numbers.items():
        for letters in TRIPLES:
            if not name.endswith(letters[0]):
                continue
            names = [name[: -len(letters[0])] + letter for letter in letters]
            if all(numbers.get(other) == domain for other in names):
                found.append(Candidate(",".join(names), domain))
    return found
