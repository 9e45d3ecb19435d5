# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the paths of moving fixed points meet: storms that merge, split, or go on as another element.

    design, notes = joined(design)      # ends that nearly meet are moved together, and each note says so
    for meeting in meetings(design.elements): meeting.words, meeting.lam, meeting.position

A path ends where its last point and its last λ are, and begins where the first are. No Blender here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .design import Design, Element

#: Ends nearer than this, over the smaller radius of the two, and at λ as near as this, are meant to meet.
NEAR, SAME_LAM = 0.3, 0.02


@dataclass(frozen=True)
class Meeting:
    """Elements by name, in their order in the design."""

    lam: float
    position: np.ndarray  #: (3,)
    ending: tuple[str, ...]
    beginning: tuple[str, ...]

    @property
    def words(self) -> str:
        """What happens as λ grows."""
        before, after = len(self.ending), len(self.beginning)
        if before > after:
            return "merge" if after else "end together"
        if after > before:
            return "split" if before else "begin together"
        return "goes on" if before == 1 else "meet"


@dataclass(frozen=True)
class _End:
    number: int  #: of the element
    last: bool  #: whether the path ends here, or begins
    lam: float
    position: np.ndarray
    radius: float


def meetings(elements: Sequence[Element]) -> list[Meeting]:
    """Of the enabled moving elements, in the order of λ."""
    return sorted((_meeting(elements, group) for group in _groups(elements)), key=lambda meeting: meeting.lam)


def joined(design: Design) -> tuple[Design, tuple[str, ...]]:
    """The design with ends that nearly meet at one place and one λ; and for each such meeting a sentence."""
    elements, notes = list(design.elements), []
    for group in _groups(design.elements):
        meeting = _meeting(design.elements, group)
        apart = max(float(np.linalg.norm(end.position - meeting.position)) for end in group)
        off = max(abs(end.lam - meeting.lam) for end in group)
        if apart <= 1e-6 * min(end.radius for end in group) and off <= 1e-9:
            continue
        for end in group:
            elements[end.number] = _moved(elements[end.number], end.last, meeting)
        names = " and ".join(f"'{name}'" for name in dict.fromkeys((*meeting.ending, *meeting.beginning)))
        notes.append(f"the ends of {names}, {apart:.3g} off the middle between them, are joined at λ {meeting.lam:.2f}")
    return replace(design, elements=tuple(elements)), tuple(notes)


def _groups(elements: Sequence[Element]) -> list[list[_End]]:
    """Ends of at least two elements that meet; each end is in one group at most.

    What begins gathers what ends: of two storms that end on both sides of it, each may be far from the other."""
    ends, groups = sorted(_ends(elements), key=lambda end: end.last), []
    while ends:
        group = [ends.pop(0)]
        group += [end for end in ends if _meet(group[0], end)]
        ends = [end for end in ends if not any(end is other for other in group)]
        if len({end.number for end in group}) > 1:
            groups.append(group)
    return groups


def _ends(elements: Sequence[Element]) -> Iterator[_End]:
    """Ends of moving elements inside the range of λ: what begins with the design begins with nothing else."""
    for number, element in enumerate(elements):
        if element.type != "singular" or not element.enabled or len(element.points) < 2 or len(element.lam) < 2:
            continue
        for last in (False, True):
            lam = element.lam[-1 if last else 0]
            if 0.0 < lam < 1.0:
                yield _End(number, last, lam, np.array(element.points[-1 if last else 0]), element.least_radius)


def _meet(a: _End, b: _End) -> bool:
    near = float(np.linalg.norm(a.position - b.position)) <= NEAR * min(a.radius, b.radius)
    return near and abs(a.lam - b.lam) <= SAME_LAM


def _meeting(elements: Sequence[Element], group: list[_End]) -> Meeting:
    """At the middle of the ends; where something begins, at the λ at which it does."""
    beginning = [end for end in group if not end.last]
    return Meeting(
        lam=float(np.mean([end.lam for end in beginning or group])),
        position=np.mean([end.position for end in group], axis=0),
        ending=_names(elements, group, last=True),
        beginning=_names(elements, group, last=False),
    )


def _names(elements: Sequence[Element], group: list[_End], last: bool) -> tuple[str, ...]:
    return tuple(elements[number].name for number in sorted(end.number for end in group if end.last == last))


def _moved(element: Element, last: bool, meeting: Meeting) -> Element:
    """The element with that end at the meeting; its points follow within one radius, less and less."""
    points, lam = np.array(element.points), list(element.lam)
    end = -1 if last else 0
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.r_[0.0, np.cumsum(steps)]
    away = arc[-1] - arc if last else arc
    share = np.clip(1.0 - away / element.least_radius, 0.0, 1.0)
    points = points + share[:, None] * (meeting.position - points[end])
    points[end] = meeting.position
    inside = (lam[0], meeting.lam) if last else (meeting.lam, lam[-1])
    lam[end] = meeting.lam
    rows = tuple((x, y, z) for x, y, z in points.tolist())
    return replace(element, points=rows, lam=tuple(min(max(value, inside[0]), inside[1]) for value in lam))
