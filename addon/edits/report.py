# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of an edit, in the words of the command line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from ..model.edits import Edit
from ..model.words import Json

if TYPE_CHECKING:
    from .single import SampleEdit

Status = Literal["applied", "refused"]
#: The reason of an edit that its author has turned off.
OFF = "it is turned off"


@dataclass(frozen=True)
class EditReport:
    """status applied: at one of its samples at least. reason: what was not done and why; empty where all was."""

    type: str
    status: Status
    reason: str
    lam: tuple[float, ...] = ()  #: the samples that were edited
    samples: tuple[SampleEdit, ...] = ()
    seconds: float = 0.0  #: that it took, with its bifurcations
    bifurcations: tuple[int, int] | None = None  #: of the field over λ, before and after

    @property
    def new_bifurcations(self) -> int:
        return 0 if self.bifurcations is None else self.bifurcations[1] - self.bifurcations[0]

    @staticmethod
    def of(edit: Edit, lambdas: Sequence[float], samples: Sequence[SampleEdit]) -> EditReport:
        applied = [sample for sample in samples if sample.applied]
        reasons = [sample.reason for sample in samples if sample.reason]
        status: Status = "applied" if applied else "refused"
        return EditReport(edit.type, status, reasons[0] if reasons else "", tuple(lambdas), tuple(samples))

    def to_json(self) -> dict[str, Json]:
        """index, left, faces and fill are those of the first sample; changes are the largest of all."""
        content: dict[str, Json] = {"type": self.type, "status": self.status, "reason": self.reason}
        if not self.samples:
            return content
        first, counts = self.samples[0], self.bifurcations
        return {
            **content,
            "lam": list(self.lam),
            "index": list(first.index) if first.index is not None else None,
            "left": [{"kind": entity.kind, "at": list(entity.at)} for entity in first.left],
            "faces": list(first.faces),
            "fill": first.fill,
            "seconds": round(self.seconds, 4),
            "bifurcations": None if counts is None else {"before": counts[0], "after": counts[1]},
            "change": {
                "angle": max(sample.largest_angle for sample in self.samples),
                "length": max(sample.largest_length for sample in self.samples),
            },
        }


def turned_off(edit: Edit) -> EditReport:
    return EditReport(edit.type, "refused", OFF)
