# SPDX-License-Identifier: GPL-3.0-or-later
"""The field as the artist sees it now, and the cache of all λ, for analyses.

Values are those of the attribute on the evaluated mesh; where later modifiers have changed its vertices or turned its
vectors, those of the λ cache at the current λ. Both belong to the vertices of the object's own mesh; analyses take the
surface in it.
"""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np

from ...cache.field_cache import FieldCache, open_cache
from ...cache.layout import MANIFEST
from ...model.errors import InputError
from ...model.manifold import Manifold, manifold
from ...model.mesh_data import MeshData
from .attached import LAMBDA, TURN, attached_folder, find_modifier
from .mesh import read_mesh


@dataclass(frozen=True, eq=False)
class CurrentField:
    mesh: MeshData  #: the surface in the object's mesh
    values: np.ndarray  #: (n, 3) float64 at its vertices, mesh units per second
    lam: float
    attribute: str
    surface: Manifold  #: how that surface belongs to the object's mesh


def why_no_field(obj: bpy.types.Object) -> str:
    """Why there is nothing to analyze, and the cure; empty when there is. Quick enough for panels."""
    if obj.mode == "EDIT":
        return "Leave Edit Mode first"
    if attached_folder(obj, LAMBDA) is None and obj.stormfield.look.shown_field not in obj.data.attributes:
        return "Solve first: there is no field on the mesh yet"
    return ""


def read_current(context: bpy.types.Context, obj: bpy.types.Object) -> CurrentField:
    """Raises InputError where there is no field, or where modifiers have changed the mesh and there is no cache."""
    attribute, mesh = obj.stormfield.look.shown_field, read_mesh(obj)
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    lam = evaluated.stormfield.lam
    turned = (
        find_modifier(obj, TURN) is not None
    )  # the evaluated vectors lie on the surface that is seen, not on the own mesh
    for carrier in (obj.data,) if turned else (evaluated.data, obj.data):
        found = carrier.attributes.get(attribute)
        fits = len(carrier.vertices) == len(mesh.vertices)
        if found is not None and fits and (found.domain, found.data_type) == ("POINT", "FLOAT_VECTOR"):
            values = np.empty(len(mesh.vertices) * 3, np.float32)
            found.data.foreach_get("vector", values)
            return _on_surface(obj, mesh, values.reshape(-1, 3), lam, attribute)
    if attached_folder(obj, LAMBDA) is None:
        raise InputError(
            f"'{obj.name}' carries no {attribute} on its own vertices; solve first, or apply the modifiers "
            "that change the mesh"
        )
    cache = cache_of(obj, mesh)
    return _on_surface(obj, mesh, cache.at(lam)[attribute], lam, attribute)


def _on_surface(obj: bpy.types.Object, mesh: MeshData, values: np.ndarray, lam: float, attribute: str) -> CurrentField:
    surface = surface_in(obj, mesh)
    return CurrentField(surface.mesh, surface.to_surface(values).astype(np.float64), lam, attribute, surface)


def surface_in(obj: bpy.types.Object, mesh: MeshData) -> Manifold:
    """The surface in the mesh of an object, as Solve takes it."""
    return manifold(mesh, obj.stormfield.solve.weld)


def cache_of(obj: bpy.types.Object, mesh: MeshData) -> FieldCache:
    """The λ cache that the object shows. Raises InputError: none, unfinished, of another mesh."""
    folder = attached_folder(obj, LAMBDA)
    if folder is None:
        raise InputError("there is no λ cache; solve first")
    cache = open_cache(Path(folder))
    cache.check_mesh(mesh)
    return cache


def is_given(obj: bpy.types.Object) -> bool:
    """Whether the field was given and not solved. Quick enough for panels."""
    folder = attached_folder(obj, LAMBDA)
    return folder is not None and not obj.stormfield.solve.solved and _has_base(str(folder))


@lru_cache(maxsize=16)
def _has_base(folder: str) -> bool:
    """Of a finished cache, whose origin never changes."""
    return (Path(folder) / MANIFEST).is_file() and "base" in open_cache(Path(folder)).settings


def base_folder(obj: bpy.types.Object) -> Path | None:
    """The λ cache that the object shows, where its field was given and not solved: imported, or of an attribute."""
    folder = attached_folder(obj, LAMBDA)
    if folder is None or not (folder / MANIFEST).is_file():
        return None
    return folder if "base" in open_cache(folder).settings else None
