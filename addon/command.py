# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line inside Blender: blender -b scene.blend --command stormfield bake --frames 1-25 --resume.

The same commands, options and exit status as the console script; it needs nothing but Blender and the extension.
"""

import bpy

_registered: list[object] = []


def run(arguments: list[str]) -> int:
    """Runs one command; Blender ends with the exit status that this returns."""
    from .cli import main

    return main(arguments)


def register() -> None:
    _registered.append(bpy.utils.register_cli_command("stormfield", run))


def unregister() -> None:
    while _registered:
        bpy.utils.unregister_cli_command(_registered.pop())
