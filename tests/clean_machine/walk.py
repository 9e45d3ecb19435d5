# SPDX-License-Identifier: GPL-3.0-or-later
"""What someone does who has Blender and the zip, run by the clean machine's own Python (test_clean_machine.py):

walk.py install ZIP     install and enable, draw, solve, analyze, bake to every target, read the files back
walk.py command WORDS   blender -b scene.blend --command stormfield WORDS, with the extension that is installed
walk.py data FILE       import a file of another program
walk.py uninstall       uninstall; nothing of the extension may be left

Everything it makes is below its working folder, which is also the home of the user.
"""

import os
import sys
from pathlib import Path

HOME = Path.cwd()
SCENE = HOME / "scene.blend"
REPOSITORY, PACKAGE = "shared", "stormfield"
#: What Blender keeps of any extension: its lists of what there is.
BLENDERS_OWN = {".blender_ext", "compat.dat"}
MODULE = f"bl_ext.{REPOSITORY}.{PACKAGE}"

_registered = {}


def main() -> int:
    import bpy

    # The bpy module has no program that would take --command.
    bpy.utils.register_cli_command = lambda name, function: _registered.setdefault(name, function) and name
    unregister = bpy.utils.unregister_cli_command
    bpy.utils.unregister_cli_command = lambda handle: (
        _registered.pop(handle) if handle in _registered else unregister(handle)
    )
    step, *words = sys.argv[1:]
    return {"install": install, "command": command, "data": data, "uninstall": uninstall}[step](*words)


def install(extension: str) -> int:
    import bpy

    bpy.context.preferences.filepaths.use_load_ui = False
    before = everything()
    add_repository()
    bpy.ops.extensions.package_install_files(filepath=extension, repo=REPOSITORY, enable_on_install=True)
    assert is_enabled(), "not enabled"
    told = sorted(everything() - before)
    assert told, "nothing was installed"
    (HOME / "installed.txt").write_text("\n".join(told))
    package = HOME / "repository" / PACKAGE
    own_files = files(package)
    bpy.ops.wm.save_userpref()
    design()
    bpy.ops.wm.save_as_mainfile(filepath=str(SCENE))
    for operator in ("solve", "analyze", "morse_sets", "bake"):
        assert getattr(bpy.ops.stormfield, operator)() == {"FINISHED"}, operator
    read_back()
    bpy.ops.wm.save_mainfile()
    assert files(package) == own_files, "the extension wrote into itself"
    return 0


def command(*words: str) -> int:
    import bpy

    add_repository()
    import addon_utils

    addon_utils.enable(MODULE)
    if SCENE.exists():
        bpy.ops.wm.open_mainfile(filepath=str(SCENE))
    return _registered["stormfield"](list(words))


def data(file: str) -> int:
    import bpy

    add_repository()
    import addon_utils

    addon_utils.enable(MODULE)
    assert bpy.ops.stormfield.import_data(filepath=file) == {"FINISHED"}
    evaluated = bpy.context.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    import numpy as np

    vectors = np.zeros(3 * len(evaluated.vertices), np.float32)
    evaluated.attributes["sf_advection"].data.foreach_get("vector", vectors)
    assert np.isfinite(vectors).all() and np.abs(vectors).max() > 0.01
    return 0


def uninstall() -> int:
    import addon_utils
    import bpy

    add_repository()
    addon_utils.enable(MODULE)
    index = next(i for i, repo in enumerate(bpy.context.preferences.extensions.repos) if repo.module == REPOSITORY)
    bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id=PACKAGE)
    assert not hasattr(bpy.types.Object, "stormfield"), "still registered"
    installed = set((HOME / "installed.txt").read_text().splitlines())
    left = {path for path in installed & everything() if not BLENDERS_OWN & set(Path(path).parts)}
    assert not left, f"left behind: {sorted(left)[:10]}"
    return 0


def design() -> None:
    """A storm that moves over a ball, in the scene that Blender starts with."""
    import bpy

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(4, 0, 0))
    ball = bpy.context.object
    bpy.ops.mesh.uv_texture_add()
    bpy.ops.stormfield.add_field()
    bpy.context.scene.cursor.location = (5, 0, 0)
    bpy.ops.stormfield.place_element(kind="vortex_ccw")
    bpy.context.view_layer.objects.active = ball
    ball.stormfield.solve.samples = 3
    bake = ball.stormfield.bake
    bake.use_frames = bake.use_exr = bake.use_vdb = bake.use_morse = True
    bake.resolution = "256"
    bpy.context.scene.frame_end = 2


def read_back() -> None:
    """The attributes are on the mesh, and Blender's own libraries find numbers in every file."""
    import bpy

    bpy.utils.expose_bundled_modules()
    import numpy as np
    import OpenImageIO
    import openvdb
    from pxr import Usd

    evaluated = bpy.context.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert {"sf_advection", "sf_morse", "sf_phase_a"} <= set(evaluated.attributes.keys()), evaluated.attributes.keys()
    vectors = np.zeros(3 * len(evaluated.vertices), np.float32)
    evaluated.attributes["sf_advection"].data.foreach_get("vector", vectors)
    assert np.isfinite(vectors).all() and np.abs(vectors).max() > 0.1
    written = HOME / "stormfield_cache"
    stages = sorted(written.rglob("field.usd*"))
    assert len(stages) >= 3, stages
    for path in stages:
        stage = Usd.Stage.Open(str(path))
        assert [prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"], path
    images = sorted(written.rglob("*.exr"))
    assert len(images) == 2, images
    for path in images:
        pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)
        assert pixels.shape[:2] == (256, 256) and np.isfinite(pixels).all() and np.abs(pixels[..., :2]).max() > 0.01
    volumes = sorted(written.rglob("*.vdb"))
    assert len(volumes) == 2, volumes
    for path in volumes:
        grids, _ = openvdb.readAll(str(path))
        assert all(grid.activeVoxelCount() > 1000 for grid in grids), [grid.name for grid in grids]


def add_repository() -> None:
    import bpy

    repos = bpy.context.preferences.extensions.repos
    if REPOSITORY not in {repo.module for repo in repos}:
        repos.new(name="Shared", module=REPOSITORY, custom_directory=str(HOME / "repository"), source="USER")


def is_enabled() -> bool:
    import addon_utils

    return addon_utils.check(MODULE)[1]


def everything() -> set[str]:
    return files(HOME)


def files(folder: Path) -> set[str]:
    """Names below a folder, without what Python compiles for itself."""
    return {
        str(path.relative_to(HOME)) for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts
    }


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # bpy 4.5 may never return from its destructors
