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

Status = Literal["applied", "in part", "refused", "off"]


@dataclass(frozen=True)
class EditReport:
    """status in part: at some of its samples, or not as far as asked. reason: why not, empty where all was done."""

    type: str
    status: Status
    reason: str
    lam: tuple[float, ...] = ()  #: the samples that were edited
    samples: tuple[SampleEdit, ...] = ()

    @staticmethod
    def of(edit: Edit, lambdas: Sequence[float], samples: Sequence[SampleEdit]) -> EditReport:
        applied = [sample for sample in samples if sample.applied]
        reasons = [sample.reason for sample in samples if sample.reason]
        status: Status = "in part" if applied else "refused"
        if len(applied) == len(samples) and not reasons:
            status = "applied"
        return EditReport(edit.type, status, reasons[0] if reasons else "", tuple(lambdas), tuple(samples))

    def to_json(self) -> dict[str, Json]:
        """index, left, faces and fill are those of the first sample; changes are the largest of all."""
        content: dict[str, Json] = {"type": self.type, "status": self.status, "reason": self.reason}
        if not self.samples:
            return content
        first = self.samples[0]
        return {
            **content,
            "lam": list(self.lam),
            "index": list(first.index) if first.index is not None else None,
            "left": [{"kind": entity.kind, "at": list(entity.at)} for entity in first.left],
            "faces": list(first.faces),
            "fill": first.fill,
            "change": {
                "angle": max(sample.largest_angle for sample in self.samples),
                "length": max(sample.largest_length for sample in self.samples),
            },
        }


def not_applied(edit: Edit, status: Status, reason: str) -> EditReport:
    return EditReport(edit.type, status, reason)
