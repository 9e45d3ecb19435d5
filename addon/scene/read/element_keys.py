# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of elements that are animated: F-curves, drivers and strips on an element's own numbers.

names = keyed_settings(obj)                     # {2: {"strength"}} by the element's place in the list
element = with_numbers(element, lams, {"strength": values})
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import bpy
import numpy as np

from ... import compat
from ...model.design import Element, Vector
from ...model.element_types import OVER_LAMBDA, RULES

_PATH = re.compile(r"stormfield\.elements\[(\d+)\]\.(\w+)$")
#: The property of an element in the list → settings of the model's Element.
_MEANS = {"strength": ("strength",), "radius": ("radius",), "angle": ("angle",), "pull": ("rate", "pull")}


def keyed_settings(obj: bpy.types.Object) -> dict[int, set[str]]:
    """Names of the animated properties of each element that has any, by its place in the list."""
    found: dict[int, set[str]] = {}
    for path in _animated_paths(obj):
        match = _PATH.match(path)
        if match and match[2] in _MEANS:
            found.setdefault(int(match[1]), set()).add(match[2])
    return found


def numbers_of(element, names: set[str]) -> dict[str, float]:
    """The values that an evaluated element of the list has now."""
    return {name: getattr(element, name) for name in names}


def with_numbers(element: Element, lams: Sequence[float], numbers: Sequence[Mapping[str, float]]) -> Element:
    """The element with its animated settings as lists over λ; numbers: one for each of the growing `lams`."""
    kept = {name: np.array([each[name] for each in numbers]) for name in numbers[0]}
    kept = {name: values for name, values in kept.items() if np.ptp(values) > 0}
    if not kept:
        return element
    start, end = element.lam[0], element.lam[-1]
    moving = RULES[element.type].moves and len(element.points) > 1
    stops = {start, end, *(lam for lam in lams if start < lam < end), *(element.lam if moving else ())}
    lam = tuple(sorted(stops))
    lists = {
        setting: tuple(np.interp(lam, lams, values).tolist())
        for name, values in kept.items()
        for setting in _MEANS[name]
        if setting in OVER_LAMBDA
    }
    points = _at(element, lam) if moving else element.points
    return replace(element, points=points, lam=lam, **lists)


def _at(element: Element, lam: Sequence[float]) -> tuple[Vector, ...]:
    """Where a moving element is at each λ."""
    drawn = np.array(element.points)
    columns = [np.interp(lam, element.lam, drawn[:, axis]).tolist() for axis in range(3)]
    return tuple((x, y, z) for x, y, z in zip(*columns, strict=True))


def _animated_paths(obj: bpy.types.Object) -> Iterator[str]:
    animation = obj.animation_data
    if animation is None:
        return
    yield from (curve.data_path for curve in compat.fcurves(obj))
    yield from (driver.data_path for driver in animation.drivers)
    for track in animation.nla_tracks:
        for strip in track.strips:
            if strip.action is not None:
                yield from (curve.data_path for curve in compat.all_fcurves(strip.action))
