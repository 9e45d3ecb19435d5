# SPDX-License-Identifier: GPL-3.0-or-later
"""Analyses as generators of steps, for the modal operators and other callers that must not block (see work.py).

    graph = run(ecg_steps(mesh, values, lam=0.3))
    tracking = run(tracking_steps(open_cache(folder), mesh, "sf_advection"))
    morse = run(morse_steps(mesh, values, lam=0.3, method="tau", tau=0.1))

Closing a generator stops the work within 0.1 s. Stop (work.py) ends a refinement with the rounds that are complete.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from .. import native
from ..cache.field_cache import FieldCache
from ..cache.fields import native_mesh, solved_surface
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.words import MorseOptions
from ..work import Step, Steps, result_of
from . import ecg, mcg, tracking
from .entities import EntityGraph
from .no_field import Region, region_without_field, with_field
from .tracking import Tracking

#: Where an analysis begins, in the fractions of its steps: before, its one field is read, or all samples.
READ_ONE, READ = 0.1, 0.4


def ecg_steps(mesh: MeshData, values: np.ndarray, lam: float) -> Steps[EntityGraph]:
    """The entity connection graph of one instantaneous field. values: (n, 3) at the vertices."""
    surface, field = yield from field_steps(mesh, values)
    region = region_without_field(surface, values)
    yield from _note(region)
    topology = yield from result_of(native.start_topology(field), READ_ONE, "Following separatrices and orbits")
    return ecg.entity_graph(with_field(topology, region), lam)


def tracking_steps(cache: FieldCache, mesh: MeshData, attribute: str, persistence: float = 0.0) -> Steps[Tracking]:
    """Paths and bifurcations over all samples of a λ cache, which must be of this mesh.

    persistence: paths that live through a shorter fraction of λ are taken out, and what they interrupt is joined.
    """
    cache.check_mesh(mesh)
    lambdas = cache.lambdas
    if len(lambdas) < 2:
        raise InputError("the cache has one sample of λ; solve with at least two to see what changes between them")
    taken = solved_surface(cache, mesh)
    surface = yield from surface_steps(taken.mesh)
    tangents = np.empty((len(lambdas), surface.vertex_count), np.complex128)
    for index in range(len(lambdas)):
        yield Step(READ * index / len(lambdas), f"Reading sample {index + 1} of {len(lambdas)}")
        sample = cache.sample(index)
        if attribute not in sample:
            raise InputError(f"{cache.folder}: has no {attribute}; solve again")
        tangents[index] = surface.to_tangent(taken.to_surface(sample[attribute]).astype(np.float64))
    field = native.ParameterizedField(surface, lambdas, tangents)
    region = region_without_field(surface, tangents)
    yield from _note(region)
    found = yield from result_of(tracking.start(field), READ, "Following fixed points over λ")
    return tracking.from_native(found.persistent(min_life=persistence) if persistence > 0 else found, region=region)


def _note(region: Region) -> Steps[None]:
    """Tell where there is no field."""
    if region.note:
        yield Step(READ_ONE, "Leaving out what has no field", notes=(region.note,))


@dataclass(frozen=True, eq=False)
class MorseSets:
    """A Morse decomposition with what further steps need. Never saved: the core's own objects."""

    decomposition: native.MorseDecomposition
    surface: native.TriangleMesh
    field: native.VectorField
    mean_speed: float  #: mesh units per second, the unit of relative errors
    graph: EntityGraph

    def simplified(self, error: float) -> MorseSets:
        """What holds for every field that differs by up to `error` mean speeds (method geometry only)."""
        simpler = self.decomposition.simplify(error * self.mean_speed)
        return replace(self, decomposition=simpler, graph=mcg.morse_graph(simpler, self.surface, self.graph.lam))


def morse_steps(mesh: MeshData, values: np.ndarray, lam: float, **options: Unpack[MorseOptions]) -> Steps[MorseSets]:
    """Morse sets of one instantaneous field; options as of native.start_morse."""
    surface, field = yield from field_steps(mesh, values)
    check_moves(values, "there is nothing to divide")
    found = yield from result_of(native.start_morse(field, **options), READ_ONE, "Dividing the surface")
    yield Step(1.0, "Ordering the sets", waiting=True)
    return MorseSets(found, surface, field, native.mean_speed(field), mcg.morse_graph(found, surface, lam))


def refine_set_steps(morse: MorseSets, index: int) -> Steps[MorseSets]:
    """One set divided further; the others and the order stay. The method geometry divides by pieces of edges, the
    others by larger τ inside the set."""
    found = yield from result_of(morse.decomposition.start_refine_set(index), 0.0, "Dividing the set")
    yield Step(1.0, "Ordering the sets", waiting=True)
    return replace(morse, decomposition=found, graph=mcg.morse_graph(found, morse.surface, morse.graph.lam))


def check_moves(values: np.ndarray, so: str) -> None:
    """Raises InputError for vectors that are all zero; so: what follows from that."""
    if not values.any():
        raise InputError(f"the field is zero everywhere; {so}")


def surface_steps(mesh: MeshData) -> Steps[native.TriangleMesh]:
    """The core's mesh, built on its own threads. Raises InputError for a mesh that is no surface."""
    return (
        yield from result_of(
            native.start_triangle_mesh(mesh.vertices, mesh.triangles), 0.0, "Reading the mesh", READ_ONE
        )
    )


def field_steps(mesh: MeshData, values: np.ndarray) -> Steps[tuple[native.TriangleMesh, native.VectorField]]:
    """As native_field, in steps."""
    _check_finite(values)
    surface = yield from surface_steps(mesh)
    return surface, native.VectorField.from_space(surface, values)


def native_field(mesh: MeshData, values: np.ndarray) -> tuple[native.TriangleMesh, native.VectorField]:
    """The core's mesh and field. Raises InputError for a mesh that is no surface, and values that are not finite."""
    _check_finite(values)
    surface = native_mesh(mesh)
    return surface, native.VectorField.from_space(surface, values)


def _check_finite(values: np.ndarray) -> None:
    if not np.isfinite(values).all():
        vertex = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
        raise InputError(f"the field is not finite at vertex {vertex}; solve again")
