# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a field, saved with the object: `Object.stormfield`."""

import bpy

from . import analysis, edit, morse
from .bake import BakeProperties
from .element import ElementProperties
from .field import FieldProperties
from .look import LookProperties
from .solve import SolveProperties

CLASSES = (
    ElementProperties,
    *edit.CLASSES,
    SolveProperties,
    BakeProperties,
    LookProperties,
    *analysis.CLASSES,
    *morse.CLASSES,
    FieldProperties,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.stormfield = bpy.props.PointerProperty(
        type=FieldProperties, name="Stormfield", override={"LIBRARY_OVERRIDABLE"}
    )


def unregister() -> None:
    del bpy.types.Object.stormfield
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
