# SPDX-License-Identifier: GPL-3.0-or-later
"""Between the solver's fields and the attributes of a cache."""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from .. import native
from ..model.design import FieldName, SolveSettings
from ..model.manifold import Manifold, manifold
from ..model.mesh_data import MeshData
from .field_cache import FieldCache
from .rotation import Rotation
from .usd import per_polygon

ORIENTATION, ADVECTION, SPEED, STREAM = "sf_orientation", "sf_advection", "sf_speed", "sf_stream"
ROTATION = "sf_rotation"
#: What a λ cache holds.
ATTRIBUTES = (ORIENTATION, ADVECTION, SPEED, STREAM, ROTATION)
#: Attribute of each of the two fields.
ATTRIBUTE: Mapping[FieldName, str] = {"orientation": ORIENTATION, "advection": ADVECTION}


def attributes_of(solution, stream: np.ndarray, indices: Iterable[int]) -> Iterator[dict[str, np.ndarray]]:
    """The vertex attributes of these samples of a Solution, float32; stream: (s, n), of its advection field."""
    rotation = Rotation(solution.fields["advection"].mesh)
    return (_attributes(solution, stream[index], rotation, index) for index in indices)


def _attributes(solution, stream: np.ndarray, rotation: Rotation, index: int) -> dict[str, np.ndarray]:
    vectors = {attribute: solution.fields[name].sample(index).to_space() for name, attribute in ATTRIBUTE.items()}
    speed = np.sqrt(np.einsum("ij,ij->i", vectors[ADVECTION], vectors[ADVECTION]))
    attributes = {**vectors, SPEED: speed, STREAM: stream, ROTATION: rotation.of(vectors[ADVECTION])}
    return {name: np.asarray(solution.to_mesh(values), np.float32) for name, values in attributes.items()}


def native_mesh(mesh: MeshData):
    return native.TriangleMesh(mesh.vertices, mesh.triangles)


def solved_surface(cache: FieldCache, mesh: MeshData) -> Manifold:
    """The surface in the mesh that the field of a cache lives on."""
    design = cache.settings.get("design")
    weld = design.get("settings", {}).get("weld", SolveSettings.weld) if isinstance(design, dict) else 0.0
    return manifold(mesh, weld)


def on_surface(attributes: Mapping[str, np.ndarray], surface: Manifold) -> dict[str, np.ndarray]:
    """The vertex attributes of a sample at the vertices of the surface."""
    return {name: surface.to_surface(values) for name, values in attributes.items() if not per_polygon(values)}


def field_at(attributes: Mapping[str, np.ndarray], attribute: str, mesh):
    """One vector attribute of a sample as native.VectorField on the native mesh."""
    return native.VectorField.from_space(mesh, attributes[attribute].astype(np.float64))


def parameterized(cache: FieldCache, attribute: str, mesh, surface: Manifold):
    """A vector attribute of a λ cache as native.ParameterizedField on the native mesh of its surface."""
    samples = cache.values(attribute)
    samples = samples if surface.same else samples[:, surface.origin]
    values = mesh.to_tangent(samples.astype(np.float64))
    return native.ParameterizedField(mesh, cache.lambdas, values)
