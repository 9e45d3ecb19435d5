# SPDX-License-Identifier: GPL-3.0-or-later
"""Design elements, added to an object's list."""

import bpy


def add_element(obj: bpy.types.Object, source: bpy.types.Object | None, **settings):
    """Append an element with a name of its own and make it active; `settings` are its properties."""
    field = obj.stormfield
    taken = {element.name for element in field.elements}
    element = field.elements.add()
    base = settings.pop("name", None) or (source.name if source else "Element")
    number = 1
    while (name := base if number == 1 else f"{base}.{number:03d}") in taken:
        number += 1
    element.name, element.source = name, source
    element.radius = settings.pop("radius", default_radius(obj))
    for key, value in settings.items():
        setattr(element, key, value)
    field.active_element = len(field.elements) - 1
    return element


def default_radius(obj: bpy.types.Object) -> float:
    """A twentieth of the object's diagonal, in mesh units: visible at once, small against the object."""
    corners = obj.bound_box
    return max(1e-4, sum((a - b) ** 2 for a, b in zip(corners[0], corners[6], strict=True)) ** 0.5 / 20.0)
