# SPDX-License-Identifier: GPL-3.0-or-later
"""Which properties of an element in the list hold the settings of the model's Element."""

from ...model.element_types import RULES, ElementType, Kind

#: The property that holds a setting, where it has another name: all lines have one pull.
PROPERTY_OF = {"rate": "pull"}
#: The property that holds the kind, of types that have kinds.
KIND_OF: dict[ElementType, str] = {
    "singular": "kind",
    "orbit": "orbit_kind",
    "bifurcation": "bifurcation_kind",
}


def kind_of(element) -> Kind:
    """The kind of an element of the list; "source" for types that have none."""
    return getattr(element, KIND_OF[element.type]) if element.type in KIND_OF else "source"


def shown_settings(element_type: ElementType) -> tuple[str, ...]:
    """The properties that count for a type, in the order of the panel, without its kind."""
    return tuple(PROPERTY_OF.get(name, name) for name in RULES[element_type].settings)
