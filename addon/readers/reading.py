# SPDX-License-Identifier: GPL-3.0-or-later
"""What a reader says beside its data: which arrays it took from where, what it did to them, and what else there is.

Reading(files=("wall.vtp",), arrays=(wss,), changes={"points welded": 124}).line()
wall.vtp: WSS (cells, 3 components); 124 points welded
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..model.words import Json


@dataclass(frozen=True)
class ArrayInfo:
    """An array of a file. location: points, cells, faces, grid, ...; unit: empty where the file has none."""

    name: str
    location: str
    components: int
    unit: str = ""

    def __str__(self) -> str:
        numbers = "1 component" if self.components == 1 else f"{self.components} components"
        return f"{self.name} ({self.location}, {numbers}{', ' + self.unit if self.unit else ''})"


@dataclass(frozen=True)
class Reading:
    """arrays: those that are the field; choices: all that could be. selected: the level, member, ... that was taken.
    times: of the samples, in time_unit, or empty where the file has none; a unit is never invented. changes: what was
    done to the data, in words, and how often. notes: guesses, and what else the user has to know, each a clause.
    tangent_share: median length of the tangent part over that of the vector."""

    files: tuple[str, ...] = ()
    arrays: tuple[ArrayInfo, ...] = ()
    choices: tuple[ArrayInfo, ...] = ()
    selected: Mapping[str, str | float] = field(default_factory=dict)
    times: tuple[float | str, ...] = ()
    time_unit: str = ""
    unit: str = ""
    changes: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    tangent_share: float | None = None

    def line(self) -> str:
        """All of it but the choices as one line."""
        parts = [", ".join(map(str, self.arrays)) or "mesh alone"]
        parts += [f"{name} {value}" for name, value in self.selected.items()]
        if self.times:
            unit = f" {self.time_unit}" if self.time_unit else ""
            span = f"{len(self.times)} times, {self.times[0]} to {self.times[-1]}"
            parts.append(f"{span if len(self.times) > 1 else f'time {self.times[0]}'}{unit}")
        parts += [f"unit {self.unit}"] if self.unit else []
        parts += [f"{count} {what}" for what, count in self.changes.items() if count]
        if self.tangent_share is not None:
            parts.append(f"tangent share {self.tangent_share:.3g}")
        return f"{_listed(self.files)}: {'; '.join([*parts, *self.notes])}"

    def name(self) -> str:
        """The files as the beginning of a message."""
        return f"{_listed(self.files)}: " if self.files else ""

    def to_json(self) -> dict[str, Json]:
        """The key "read" of every JSON."""
        return {
            "files": list(self.files),
            "arrays": [vars(array) for array in self.arrays],
            "choices": [vars(array) for array in self.choices],
            "selected": dict(self.selected),
            "times": list(self.times),
            "time_unit": self.time_unit,
            "unit": self.unit,
            "changes": {what: int(count) for what, count in self.changes.items() if count},
            "notes": list(self.notes),
            "tangent_share": self.tangent_share,
        }


def _listed(files: tuple[str, ...]) -> str:
    if len(files) < 3:
        return ", ".join(files) or "no file"
    return f"{files[0]} to {files[-1]} ({len(files)} files)"
