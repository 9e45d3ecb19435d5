# SPDX-License-Identifier: GPL-3.0-or-later
"""What `blender -b [SCENE] --command NAME ARGUMENTS...` does, by the bpy module, which has no program: opens the scene,
calls the function that was registered under that name, and ends with what it returns."""

import os
import sys


def main(words: list[str]) -> int:
    import bpy
    import stormfield

    registered = {}

    def register_cli_command(name, function):
        registered[name] = function
        return name

    bpy.utils.register_cli_command = register_cli_command
    bpy.utils.unregister_cli_command = registered.pop
    stormfield.register()
    split = words.index("--command")
    opened = [word for word in words[:split] if word not in ("-b", "--background")]
    if opened:
        bpy.ops.wm.open_mainfile(filepath=opened[0])
    name, *arguments = words[split + 1 :]
    return registered[name](arguments)


if __name__ == "__main__":
    status = main(sys.argv[1:])
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # bpy 4.5 may never return from its destructors
