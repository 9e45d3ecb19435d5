# SPDX-License-Identifier: GPL-3.0-or-later
"""Between the solver's fields and the attributes of a cache."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

import numpy as np

from .. import native
from ..model.design import FieldName, SolveSettings
from ..model.manifold import Manifold, manifold
from ..model.mesh_data import MeshData
from ..work import abandon
from .field_cache import FieldCache
from .usd import per_polygon

ORIENTATION, ADVECTION, SPEED, STREAM = "sf_orientation", "sf_advection", "sf_speed", "sf_stream"
ROTATION = "sf_rotation"
#: What a λ cache holds.
ATTRIBUTES = (ORIENTATION, ADVECTION, SPEED, STREAM, ROTATION)
#: Attribute of each of the two fields.
ATTRIBUTE: Mapping[FieldName, str] = {"orientation": ORIENTATION, "advection": ADVECTION}
#: Samples whose attributes are found together.
BLOCK = 16
#: Seconds that are waited for them at once.
PATIENCE = 0.01


class Solved(Protocol):
    """What is written of a solve: its fields by name, and the way from their surface to the mesh."""

    @property
    def lambdas(self) -> np.ndarray: ...
    @property
    def fields(self) -> Mapping[FieldName, native.ParameterizedField]: ...
    def to_mesh(self, values: np.ndarray) -> np.ndarray: ...


def attributes_of(solution: Solved) -> Iterator[dict[str, np.ndarray] | None]:
    """The vertex attributes of all samples of a solve in order, float32; None while the next ones are not there yet.
    The core finds those of the next block while the caller writes one."""
    count = len(solution.lambdas)
    orientation, advection = (solution.fields[name] for name in ATTRIBUTE)
    blocks = (
        native.start_field_attributes(orientation, advection, first, min(BLOCK, count - first))
        for first in range(0, count, BLOCK)
    )
    job = next(blocks, None)
    try:
        while job is not None:
            while not job.wait(PATIENCE):
                yield None
            found, job = job.result(), next(blocks, None)
            values = values_of(found)
            for sample in range(len(found.speed)):
                yield {name: solution.to_mesh(each[sample]) for name, each in values.items()}
    finally:
        if job is not None:
            abandon(job)


def values_of(found: native.FieldAttributes) -> dict[str, np.ndarray]:
    """The values of some samples by attribute: (k, n, 3) or (k, n)."""
    return {
        ORIENTATION: found.orientation,
        ADVECTION: found.advection,
        SPEED: found.speed,
        STREAM: found.stream,
        ROTATION: found.rotation,
    }


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
