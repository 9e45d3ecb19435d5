# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a field that was given: imported, or of an attribute. The cache before edits stays beside the edited one,
which names it, so that each list of edits is applied to the field as it was given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..cache import fields
from ..cache.field_cache import open_cache
from ..cache.layout import MANIFEST
from ..edits.memory import EditMemory
from ..model.design import FIELDS
from ..model.edits import Edit
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..model.words import Json
from ..work import Steps, scaled
from .edited import Fields, edited_fields, outcome_of, write_outcomes
from .given import GivenField, given_steps

#: Member of a given cache's settings: the folder of the cache before edits, beside it.
UNEDITED = "unedited"
#: Where the edits are applied, in the fractions of all steps.
EDITED = 0.6


def unedited_folder(folder: Path, settings: Mapping[str, Json]) -> Path:
    """The cache of a given field before edits. Raises InputError where it is gone."""
    name = settings["base"].get(UNEDITED)
    found = folder if name is None else folder.parent / name
    if not (found / MANIFEST).is_file():
        raise InputError(
            f"the field before its edits, '{found.name}', is gone: import it, or read its attribute, again"
        )
    return found


def edited_given_steps(
    folder: Path,
    mesh: MeshData,
    edits: Sequence[Edit],
    polygons: Polygons | None = None,
    memory: EditMemory | None = None,
) -> Steps[Path]:
    """The given field of a λ cache, edited or not, with these edits instead of its own → its λ cache, beside it."""
    unedited = unedited_folder(folder, open_cache(folder).settings)
    if not edits:
        return unedited
    cache = open_cache(unedited)
    cache.check_mesh(mesh)
    surface = fields.solved_surface(cache, mesh)
    native = fields.native_mesh(surface.mesh)
    given = {name: cache.values(its) for name, its in fields.ATTRIBUTE.items()}
    moves = fields.parameterized(cache, fields.ADVECTION, native, surface)
    same = np.array_equal(given["orientation"], given["advection"])
    turns = moves if same else fields.parameterized(cache, fields.ORIENTATION, native, surface)
    before: Fields = {"orientation": turns, "advection": moves}
    edited = yield from scaled(edited_fields(before, edits, memory), 0.0, EDITED)
    vectors = {
        name: [
            _after(given[name][j], before[name].sample(j), edited.fields[name].sample(j), surface)
            for j in range(len(cache.lambdas))
        ]
        for name in FIELDS
    }
    origin = {**cache.settings["base"], UNEDITED: unedited.name, "edits": [edit.to_json() for edit in edits]}
    made = GivenField(tuple(cache.lambdas.tolist()), vectors["advection"], origin, vectors["orientation"])
    target = yield from scaled(given_steps(mesh, made, unedited.parent, polygons), EDITED, 1.0)
    write_outcomes(target, tuple(outcome_of(reports) for reports in edited.reports))
    return target


def _after(given: np.ndarray, before, after, surface) -> np.ndarray:
    """(n, 3) the given vectors, with those that an edit changed from it."""
    vectors = np.array(given, np.float64)
    changed = surface.to_mesh(np.asarray(before.values) != np.asarray(after.values)).astype(bool)
    vectors[changed] = surface.to_mesh(after.to_space())[changed]
    return vectors
