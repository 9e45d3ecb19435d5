# SPDX-License-Identifier: GPL-3.0-or-later
"""What a solve leaves for the next one of the same object: its solution before edits, and what each edit made of it.

A list of edits that was changed then costs what was changed in it: the design is not solved again. The bits are those
of a solve without it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..edits.memory import EditMemory
from ..solve import Solution


@dataclass
class Reuse:
    key: str = ""  #: of the design without edits, and of the mesh
    solution: Solution | None = None
    warm: bool = False  #: whether it was solved from an earlier solution, on which its bits depend
    edits: EditMemory = field(default_factory=EditMemory)

    def holds(self, key: str) -> bool:
        return self.solution is not None and self.key == key

    def keep(self, key: str, solution: Solution, *, warm: bool) -> None:
        self.key, self.solution, self.warm = key, solution, warm
