# SPDX-License-Identifier: GPL-3.0-or-later
"""What edits made of the λ samples that they touch, kept while an artist works on their list.

memory = EditMemory()
run(edit_steps(field, edits, memory=memory))    # later, with one edit changed: the others are found here

An edit is known by what it says and by the bits of the samples that it reads, so that what is found is what applying it
again would give, and an edit that others changed nothing for is not done again.
"""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.edits import Edit
from .report import EditReport

#: Bytes of samples that are kept; the edits that were used last.
LIMIT = 512 * 2**20


@dataclass(frozen=True, eq=False)
class Made:
    """The samples of an edit's window after it, and what became of it."""

    values: np.ndarray
    report: EditReport


class EditMemory:
    def __init__(self, limit: int = LIMIT) -> None:
        self._limit = limit
        self._made: OrderedDict[str, Made] = OrderedDict()

    def find(self, key: str) -> Made | None:
        if key in self._made:
            self._made.move_to_end(key)
        return self._made.get(key)

    def keep(self, key: str, made: Made) -> None:
        self._made[key] = made
        while len(self._made) > 1 and sum(each.values.nbytes for each in self._made.values()) > self._limit:
            self._made.popitem(last=False)


def key_of(mesh: native.TriangleMesh, edit: Edit, *arrays: np.ndarray) -> str:
    """Of an edit that acts on these arrays."""
    content = {name: value for name, value in edit.to_json().items() if name not in ("enabled", "field")}
    digest = hashlib.blake2b(json.dumps(content, sort_keys=True).encode(), digest_size=20)
    shape: list[np.ndarray] = [np.asarray(mesh.vertices), np.asarray(mesh.triangles)]
    for array in (*shape, *arrays):
        digest.update(repr((array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
