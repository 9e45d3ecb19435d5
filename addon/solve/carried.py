# SPDX-License-Identifier: GPL-3.0-or-later
"""From the surface that a field was solved on to the mesh of the artist.

Parts that were cut off (a fin, an inner wall) and hold no element have the field of the nearest place of the surface
that they hang on. Parts that stand alone and hold no element have none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.cutting import connected
from ..model.design import FIELDS
from ..model.errors import InputError
from ..model.manifold import Manifold


@dataclass(frozen=True, eq=False)
class _Nearest:
    """For vertices of the surface the triangles of solved ones to read from, and their normals."""

    vertices: np.ndarray
    corners: np.ndarray
    weights: np.ndarray
    normals: np.ndarray

    def fill(self, values: np.ndarray) -> np.ndarray:
        """A copy of (k,) or (k, 3) values with these vertices filled; vectors are laid into their tangent planes."""
        filled = np.array(values)
        found = np.einsum("uc,uc...->u...", self.weights, filled[self.corners])
        if found.ndim == 2:
            found -= self.normals * np.einsum("ij,ij->i", self.normals, found)[:, None]
        filled[self.vertices] = found
        return filled


class Carried:
    """without: components of the surface that no element of one of the fields reaches."""

    def __init__(self, manifold: Manifold, surface: native.TriangleMesh, without: list[int]) -> None:
        self._manifold, self._surface = manifold, surface
        self._hanging = _hanging(manifold, surface, without) if len(without) < surface.component_count else set()
        self._nearest = _nearest(surface, self._hanging) if self._hanging else None

    def to_mesh(self, values: np.ndarray) -> np.ndarray:
        """(k, …) at the vertices of the surface → (n, …) at those of the mesh."""
        filled = values if self._nearest is None else self._nearest.fill(values)
        return self._manifold.to_mesh(filled[: len(self._manifold.origin)])  # those of a refined mesh come first

    def faces(self, numbers: Sequence[int]) -> np.ndarray:
        """Triangles of the surface that lie in these of the mesh. Raises InputError for one that does not exist."""
        wrong = next((number for number in numbers if not 0 <= number < self._manifold.faces), None)
        if wrong is not None:
            raise InputError(f"there is no face {wrong}; the mesh has {self._manifold.faces}")
        own = self._manifold.triangles
        times = len(self._surface.triangles) // len(own)  # a refined triangle is followed by its parts
        return np.flatnonzero(np.repeat(np.isin(own, numbers), times)).astype(np.int32)

    def line(self) -> str:
        """One sentence on what of the mesh is no surface; empty where nothing is."""
        line = self._manifold.remarks.line()
        if self._hanging:
            one = len(self._hanging) == 1
            line += f"; {len(self._hanging)} {'part' if one else 'parts'} without element took the nearest vectors"
        return line

    def without_field(self, names: tuple[str, ...], components: list[int]) -> str:
        """One sentence on components that stand alone and have no field; empty where there are none."""
        alone = [component for component in components if component not in self._hanging]
        if not alone:
            return ""
        sizes = np.bincount(self._surface.components[self._surface.components >= 0])
        which = ", ".join(f"part {component + 1} with {sizes[component]} vertices" for component in alone[:4])
        more = f" and {len(alone) - 4} more" if len(alone) > 4 else ""
        field = "" if len(names) == len(FIELDS) else f" of the {names[0]} field"
        few = f"{len(alone)} of {self._surface.component_count} parts of the mesh"
        have = "has" if len(alone) == 1 else "have"
        return f"{few} {have} no element{field}, so nothing flows there ({which}{more}): add an element, or leave it so"


def _hanging(manifold: Manifold, surface: native.TriangleMesh, without: list[int]) -> set[int]:
    """Components without element that share vertices of the mesh, over others too, with one that has elements."""
    if not without or manifold.same:
        return set()
    component = surface.components[manifold.mesh.triangles].ravel()
    order = np.argsort(manifold.joints, kind="stable")
    same = manifold.joints[order][1:] == manifold.joints[order][:-1]
    group = connected(surface.component_count, component[order[:-1][same]], component[order[1:][same]])
    solved = set(range(surface.component_count)) - set(without)
    held = {group[part] for part in solved}
    return {part for part in without if group[part] in held}


def _nearest(surface: native.TriangleMesh, hanging: set[int]) -> _Nearest:
    components, triangles = surface.components, surface.triangles
    empty = np.isin(components, list(hanging))
    vertices = np.flatnonzero(empty)
    kept = triangles[~empty[triangles[:, 0]]]
    solved = native.TriangleMesh(surface.vertices, kept)
    faces, weights, _distances = solved.closest_points(surface.vertices[vertices])
    normals = np.zeros((surface.vertex_count, 3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], surface.face_normals * surface.face_areas[:, None])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return _Nearest(vertices, kept[faces], weights, (normals / np.where(length > 0, length, 1.0))[vertices])
