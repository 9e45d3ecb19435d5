# SPDX-License-Identifier: GPL-3.0-or-later
"""Given vectors and mesh → λ cache: the base field of an object, from an attribute or from data.

    folder = run(given_steps(mesh, GivenField(lambdas, vectors, origin), root, polygons))

The cache holds what a solved one holds, so that analyses, streamlines and bakes work on it as on that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path

import numpy as np

from .. import native
from ..cache import fields
from ..cache.field_cache import FieldCacheWriter
from ..cache.plan import MeshIdentity, Plan
from ..model.manifold import Manifold, manifold
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..model.words import Json
from ..version import VERSION
from ..work import Step, Steps, between, result_of, scaled
from .unfinished import unfinished

#: Where samples are written, in the fractions of all steps.
WRITTEN = 0.95


@dataclass(frozen=True, eq=False)
class GivenField:
    """lambdas: increasing, in 0..1. vectors: (n, 3) in object space, mesh units per second, for each λ, made when they
    are asked for or there already; what is across the surface is left out. origin: what they are made from; the cache
    is found again by it, so that it has to change with them. orientation: where it is another field than what moves."""

    lambdas: tuple[float, ...]
    vectors: Iterable[np.ndarray]
    origin: Mapping[str, Json]
    orientation: Iterable[np.ndarray] | None = None


def given_steps(
    mesh: MeshData, given: GivenField, root: Path, polygons: Polygons | None = None, *, folder: Path | None = None
) -> Steps[Path]:
    """Writes the λ cache root/lambda-<key>, or `folder`, of a given field, one sample after another; returns it."""
    settings = {"base": dict(given.origin), "attributes": list(fields.ATTRIBUTES), "stormfield": VERSION}
    plan = Plan("usd", "lambda", given.lambdas, MeshIdentity.of(mesh), settings)
    target = folder or Path(root) / plan.folder_name("lambda")
    writer = FieldCacheWriter(target, mesh, plan.times, settings, polygons=polygons, resume=True)
    missing = set((yield from unfinished(writer, range(len(plan.times)))))
    if missing:
        surface = _Surface(manifold(mesh))
        for j, (vectors, turns) in enumerate(_all(given)):
            start, end = (between(0.0, WRITTEN, (j + part) / len(plan.times)) for part in (0, 1))
            if j in missing:
                attributes = yield from scaled(_attributes(surface, vectors, turns), start, end)
                writer.write_sample(j, attributes)
            yield Step(end, f"Writing sample {j + 1} of {len(plan.times)}")
    yield from scaled(writer.finish(), WRITTEN, 1.0)
    return target


def _all(given: GivenField) -> Iterator[tuple[np.ndarray, np.ndarray | None]]:
    """Advection and, where it is another one, orientation, sample by sample."""
    yield from zip(given.vectors, repeat(None) if given.orientation is None else given.orientation, strict=False)


class _Surface:
    """The surface in the mesh, as a solve takes it."""

    def __init__(self, part: Manifold) -> None:
        self.part = part
        self.mesh = fields.native_mesh(part.mesh)

    def one(self, vectors: np.ndarray) -> native.ParameterizedField:
        """A field of one sample, from (n, 3) at the vertices of the mesh."""
        field = native.VectorField.from_space(self.mesh, self.part.to_surface(np.asarray(vectors, np.float64)))
        return native.ParameterizedField(self.mesh, np.zeros(1), np.asarray(field.values)[None])


def _attributes(surface: _Surface, vectors: np.ndarray, turns: np.ndarray | None) -> Steps[dict[str, np.ndarray]]:
    """What a λ cache holds of one λ."""
    advection = surface.one(vectors)
    orientation = advection if turns is None else surface.one(turns)
    job = native.start_field_attributes(orientation, advection, 0, 1)
    found = yield from result_of(job, 0.0, "Finding the stream function")
    return {name: surface.part.to_mesh(values[0]) for name, values in fields.values_of(found).items()}
