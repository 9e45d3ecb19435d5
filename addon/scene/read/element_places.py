# SPDX-License-Identifier: GPL-3.0-or-later
"""The elements of an object that make fixed points, as analysis/naming.py compares them with what an analysis found."""

import bpy
import numpy as np

from ...analysis.naming import ElementPlace
from .element_lines import element_lines


def element_places(obj: bpy.types.Object) -> list[ElementPlace]:
    """Of the elements that are turned on; of those from animation the place of the current frame alone."""
    places = []
    for element in obj.stormfield.elements:
        if element.type != "singular" or not element.enabled or element.source is None:
            continue
        ends = (0.0, 1.0) if element.from_animation else (element.lam_start, element.lam_end)
        for line in element_lines(obj, element.source):
            points = line[:1] if element.source.type == "EMPTY" else line
            arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
            share = arc / arc[-1] if arc[-1] > 0 else arc
            places.append(
                ElementPlace(element.name, element.radius, ends[0] + share * (ends[1] - ends[0]), points, ends)
            )
    return places
