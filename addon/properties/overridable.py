# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that a shot may change on an object that it has linked from another file (library overrides)."""

from typing import TypeVar

import bpy

Group = TypeVar("Group", bound=type[bpy.types.PropertyGroup])


def overridable(group: Group) -> Group:
    """Class decorator: all settings of a group can be overridden, and lists be added to."""
    for setting in group.__annotations__.values():
        adds = {"USE_INSERTION"} if setting.function == bpy.props.CollectionProperty else set()
        setting.keywords["override"] = {"LIBRARY_OVERRIDABLE"} | adds
    return group
