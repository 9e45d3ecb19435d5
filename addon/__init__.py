# SPDX-License-Identifier: GPL-3.0-or-later
"""Stormfield: vector fields on surfaces that change over time, designed in Blender.

The package imports without Blender (command line, pipelines); everything that needs bpy is imported inside register().
"""

from . import version

__version__ = version.VERSION


def _modules():
    """The parts with something to register, in the order of their dependence."""
    from . import assets, command, handlers, manual, operators, preferences, properties, ui

    return (properties, operators, ui, manual, handlers, preferences, command, assets)


def register() -> None:
    for module in _modules():
        module.register()


def unregister() -> None:
    for module in reversed(_modules()):
        module.unregister()
