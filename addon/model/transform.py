# SPDX-License-Identifier: GPL-3.0-or-later
"""How a field turns, grows and stretches over λ, as plain data (thesis 11.1.3.4).

A course is the value of one of the three at some λ: ((λ, value), …), λ increasing. In between angles are linear and
factors geometric; before the first λ nothing changes, and after the last one the value stays.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from .errors import InputError
from .words import Json

Course = tuple[tuple[float, float], ...]
#: What is stretched along: the orientation field, or a direction in object space that is laid into the surface.
Axis = Literal["orientation"] | tuple[float, float, float]
#: The values that change nothing.
IDENTITY = {"angle": 0.0, "scale": 1.0, "stretch": 1.0}


@dataclass(frozen=True)
class Transform:
    angle: Course = ()  #: degrees, counter-clockwise seen from outside
    scale: Course = ()  #: factors of lengths, above 0
    stretch: Course = ()  #: factors of lengths along the axis, above 0
    axis: Axis = "orientation"
    frozen: bool = False  #: of the field as it is at the first λ
    falloff: float = 0.0  #: mesh units around the region, where it has one

    @property
    def begin(self) -> float:
        """λ from which on the field is another."""
        return min(course[0][0] for course in (self.angle, self.scale, self.stretch) if course)

    def keys(self) -> np.ndarray:
        """(k, 4) float64: λ, angle (radians), scale, stretch, at every λ that a course names."""
        lambdas = np.unique([lam for course in (self.angle, self.scale, self.stretch) for lam, _value in course])
        angle, scale, stretch = (_values(getattr(self, name), name, lambdas) for name in IDENTITY)
        return np.column_stack([lambdas, np.radians(angle), scale, stretch])


def transform_from_json(data: Mapping[str, Json], lam: tuple[float, float], where: str) -> Transform:
    """From the members of an edit; numbers are reached from nothing over the range of λ. Raises InputError."""
    given = [name for name in IDENTITY if name in data]
    if not given:
        raise InputError(f"{where}: transform needs angle, scale or stretch: add one")
    courses = {name: _course(data[name], name, lam, where) for name in given}
    axis = data.get("axis", "orientation")
    if axis != "orientation":
        axis = tuple(float(value) for value in axis)
        if not any(axis):
            raise InputError(f"{where}: the axis has no length: give a direction")
    if "axis" in data and "stretch" not in data:
        raise InputError(f"{where}: an axis belongs to stretch: add stretch, or remove axis")
    if "falloff" in data and "region" not in data:
        raise InputError(f"{where}: falloff belongs to a region: add region, or remove falloff")
    return Transform(**courses, axis=axis, frozen=data.get("frozen", False), falloff=float(data.get("falloff", 0.0)))


def _course(value: Json, name: str, lam: tuple[float, float], where: str) -> Course:
    if not isinstance(value, list):
        start = ((lam[0], IDENTITY[name]),) if lam[1] > lam[0] else ()
        return (*start, (lam[1], float(value)))
    course = tuple((float(at), float(what)) for at, what in value)
    late = next((b for a, b in pairwise(course) if b[0] <= a[0]), None)
    if late is not None:
        raise InputError(f"{where}: {name} at λ {late[0]:g} does not come after the one before: sort by λ")
    if name != "angle" and any(factor <= 0.0 for _at, factor in course):
        raise InputError(f"{where}: {name} is a factor: give numbers above 0")
    return course


def _values(course: Course, name: str, lambdas: np.ndarray) -> np.ndarray:
    if not course:
        return np.full(len(lambdas), IDENTITY[name])
    at, values = np.array(course).T
    if name == "angle":
        return np.interp(lambdas, at, values)
    return np.exp(np.interp(lambdas, at, np.log(values)))
