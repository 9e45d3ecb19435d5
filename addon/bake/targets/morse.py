# SPDX-License-Identifier: GPL-3.0-or-later
"""Morse sets over λ, per face: `sf_morse`, the number of the set, and `sf_morse_kind`, its place in KINDS; -1 for none.

A number means the same set at every λ. From one sample to the next the field changes by at most |V' - V| at each
vertex, and the sets of the geometry-based map of that error bound (native/morse/error_bound.h) enclose those of every
field in between. So only sets inside the same enclosure can be one set before and after: of these, first those of the
same kind, then those that share most of their area, then the nearest. A set without a predecessor gets a new number.

    morse = MorseSamples(cache, mesh, settings)          # MeshData, task.MorseSettings
    for j in range(len(cache.lambdas)):                  # in this order: numbers continue from the last sample
        attributes = run(morse.steps(j, polygons))
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from ... import native
from ...cache import fields
from ...cache.field_cache import FieldCache, FieldCacheWriter
from ...cache.plan import MeshIdentity, Plan
from ...model.mesh_data import MeshData
from ...model.polygons import Polygons
from ...model.words import MorseOptions
from ...work import Steps, result_of, scaled
from ..task import BakeTask, MorseSettings
from .target import Origin

MORSE, KIND = "sf_morse", "sf_morse_kind"
#: Kinds by their number in KIND.
KINDS = ("source", "sink", "saddle", "attracting", "repelling", "trivial", "other")
#: Where the sets of a sample are found, in the fractions of its steps; their numbers follow.
SETS_END = 0.7


class MorseCache:
    """A λ cache of the Morse sets. Of several machines the one with the first frame writes all of it."""

    name: ClassVar[str] = "morse"

    def __init__(self, task: BakeTask, cache: FieldCache, origin: Origin) -> None:
        self._task, self._cache = task, cache
        plan = self.plan(task, cache.lambdas, origin)
        self.folder: Path = task.root / plan.folder_name(self.name)
        self._polygons = task.polygons or Polygons.of_triangles(task.mesh.triangles)
        self._writer = FieldCacheWriter(
            self.folder, task.mesh, plan.times, plan.settings, polygons=self._polygons, resume=task.resume, replace=True
        )

    @classmethod
    def plan(cls, task: BakeTask, lambdas: np.ndarray, origin: Origin) -> Plan:
        settings = {"morse": vars(task.morse), "from": {name: origin[name] for name in ("field", "stormfield")}}
        return Plan("usd", "lambda", tuple(lambdas.tolist()), MeshIdentity.of(task.mesh), settings)

    @staticmethod
    def check(task: BakeTask) -> None:
        """The core checks the settings."""

    def samples(self, indices: set[int]) -> Iterable[int]:
        return range(len(self._cache.lambdas)) if 0 in indices else ()

    def missing(self, among: Iterable[int]) -> list[int]:
        return self._writer.missing(among)

    def write(self, samples: list[int]) -> Steps[list[str]]:
        morse = MorseSamples(self._cache, self._task.mesh, self._task.morse)
        # Numbers continue from sample to sample: those before a missing one are found again.
        count = samples[-1] + 1
        for j in range(count):
            message = f"Dividing the surface at sample {j + 1} of {len(self._cache.lambdas)}"
            attributes = yield from scaled(morse.steps(j, self._polygons, message), j / count, (j + 1) / count)
            if j in samples:
                self._writer.write_sample(j, attributes)
        return []

    def absent(self) -> list[str]:
        return self._writer.absent()

    def finish(self) -> Steps[bool]:
        return self._writer.finish(verify=self._task.verify)


@dataclass(frozen=True, eq=False)
class Sets:
    """The Morse sets of one sample, and the numbers they have over λ."""

    of: np.ndarray  #: (m,) int32, the set of every triangle, -1 for none
    kinds: np.ndarray  #: (k,) int32, of every set, places in KINDS
    numbers: np.ndarray  #: (k,) int32


class MorseSamples:
    def __init__(self, cache: FieldCache, mesh: MeshData, settings: MorseSettings):
        self._cache, self._settings = cache, settings
        self._surface = fields.solved_surface(cache, mesh)
        self._mesh = fields.native_mesh(self._surface.mesh)
        self._areas = self._mesh.face_areas
        self._centres = self._mesh.vertices[self._mesh.triangles].mean(axis=1)
        self._last: tuple[native.VectorField, Sets] | None = None
        self._count = 0

    def steps(self, index: int, polygons: Polygons, message: str = "") -> Steps[dict[str, np.ndarray]]:
        """The attributes of sample `index`, int32 per polygon. Raises InputError where the settings cannot be used."""
        field = fields.field_at(
            fields.on_surface(self._cache.sample(index), self._surface), self._settings.attribute, self._mesh
        )
        of, kinds = np.full(len(self._areas), -1, np.int32), np.empty(0, np.int32)
        if np.any(field.values):  # a field that is zero everywhere has no sets
            options: MorseOptions = {**self._settings.options(), "persistence": False}
            job = native.start_morse(field, **options)
            found = yield from result_of(job, 0.0, message, SETS_END)
            of = np.asarray(found.face_sets, np.int32)
            kinds = np.array([KINDS.index(s.kind) for s in found.sets], np.int32)
        numbers = np.full(len(kinds), -1, np.int32)
        if self._last is not None:
            before, sets = self._last
            change = np.abs(field.values - before.values)
            job = native.start_morse(before, eps=1.0, weights=change, persistence=False)
            around = yield from result_of(job, SETS_END, message)
            numbers = continued(sets, Sets(of, kinds, numbers), around.face_sets, self._areas, self._centres)
        fresh = np.flatnonzero(numbers < 0)
        numbers[fresh] = self._count + np.arange(len(fresh))
        self._count += len(fresh)
        self._last = field, Sets(of, kinds, numbers)
        return {
            name: polygons.of_triangle_values(self._surface.of_triangles(_at(values, of)))
            for name, values in ((MORSE, numbers), (KIND, kinds))
        }


def continued(before: Sets, after: Sets, around: np.ndarray, areas: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """The numbers that sets of `before` hand on to sets of `after`, (k,) int32, -1 for those that are new.

    around: (m,) the enclosure of every triangle, -1 for none; areas, centres: (m,) and (m, 3), of the triangles.
    """
    first, second = _enclosures(before, around), _enclosures(after, around)
    one, other = np.nonzero(first[:, None] == second[None, :])
    shared = _shared(before, after, areas)[one, other]
    unlike = before.kinds[one] != after.kinds[other]
    middles = _middles(before, areas, centres)[one] - _middles(after, areas, centres)[other]
    order = np.lexsort((other, one, np.linalg.norm(middles, axis=1), -shared, unlike))
    numbers = np.full(len(after.kinds), -1, np.int32)
    given = np.zeros(len(before.kinds), bool)
    for pair in order[(~unlike | (shared > 0))[order]]:
        a, b = one[pair], other[pair]
        if not given[a] and numbers[b] < 0:
            given[a], numbers[b] = True, before.numbers[a]
    return numbers


# Steps ----------------------------------------------------------------------------------------------------------------


def _at(per_set: np.ndarray, of: np.ndarray) -> np.ndarray:
    values = np.full(len(of), -1, np.int32)
    values[of >= 0] = per_set[of[of >= 0]]
    return values


def _enclosures(sets: Sets, around: np.ndarray) -> np.ndarray:
    """The enclosure that holds most triangles of each set. Sets of maps of the flow may reach beyond one."""
    inside = sets.of >= 0
    held = np.zeros((len(sets.kinds), int(around.max(initial=-1)) + 2), np.int64)
    np.add.at(held, (sets.of[inside], around[inside] + 1), 1)
    return held.argmax(axis=1) - 1


def _shared(before: Sets, after: Sets, areas: np.ndarray) -> np.ndarray:
    """The area that every set before and every set after have in common."""
    both = (before.of >= 0) & (after.of >= 0)
    shared = np.zeros((len(before.kinds), len(after.kinds)))
    np.add.at(shared, (before.of[both], after.of[both]), areas[both])
    return shared


def _middles(sets: Sets, areas: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """(k, 3) centres of mass."""
    inside = sets.of >= 0
    mass, moment = np.zeros(len(sets.kinds)), np.zeros((len(sets.kinds), 3))
    np.add.at(mass, sets.of[inside], areas[inside])
    np.add.at(moment, sets.of[inside], areas[inside, None] * centres[inside])
    return moment / np.maximum(mass, 1e-300)[:, None]
