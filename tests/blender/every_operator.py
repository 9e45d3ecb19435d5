# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports every module of the add-on and runs every operator, with all packages hidden that Blender and the zip lack.

python tests/blender/every_operator.py FOLDER       a folder for caches; prints EVERY OPERATOR and ends with 0
"""

import importlib
import os
import pkgutil
import re
import sys
from importlib.abc import MetaPathFinder
from importlib.metadata import packages_distributions
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
#: What the Python of Blender's own builds brings.
BLENDER_HAS = {
    *("bpy", "numpy", "requests", "urllib3", "idna", "certifi", "charset-normalizer", "zstandard", "cython"),
    *("cattrs", "attrs", "typing-extensions"),
}
#: Modules that Blender carries itself, whatever else this Python has under their names.
BUNDLED = {"pxr", "openvdb", "OpenImageIO", "PyOpenColorIO", "MaterialX"}


class Hide(MetaPathFinder):
    """Refuses modules of distributions that are not allowed."""

    def __init__(self, allowed: set[str]):
        tops = packages_distributions()
        plain = {re.sub(r"[-_.]+", "-", name).lower() for name in allowed}
        self.hidden = {
            top
            for top, owners in tops.items()
            if top not in BUNDLED and not plain & {re.sub(r"[-_.]+", "-", o).lower() for o in owners}
        }
        self.asked: set[str] = set()

    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in self.hidden:
            self.asked.add(name)
            raise ModuleNotFoundError(f"No module named '{name}': neither Blender nor the zip has it", name=name)
        return None


def hide_packages() -> Hide:
    import build_extension

    libraries = {library.partition("==")[0] for library in build_extension.libraries()}
    hide = Hide(BLENDER_HAS | libraries | {"stormfield"})
    for name in [name for name in sys.modules if name.partition(".")[0] in hide.hidden]:
        del sys.modules[name]
    sys.meta_path.insert(0, hide)
    return hide


def import_everything(package) -> None:
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)


def main(folder: Path) -> None:
    hide = hide_packages()
    assert "pytest" in hide.hidden, "nothing is hidden; install the development packages"
    import bpy
    import stormfield

    import_everything(stormfield)
    stormfield.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "work.blend"))
    from stormfield.operators import solve

    state = solve.solver_state.SolverState()
    solve.solver_state.of = lambda _obj: state  # as in a window, where a second solve starts from the first
    done = Operators()
    walk(done, stormfield)
    for name in sorted(done.registered() - done.run):  # newer than this script
        done.tried(name)
    print("EVERY OPERATOR", flush=True)


class Operators:
    """bpy.ops.stormfield, which knows what was run. An operator that may not be run here says so."""

    def __init__(self):
        self.run: set[str] = set()

    def __getattr__(self, name):
        import bpy

        operator = getattr(bpy.ops.stormfield, name)

        def call(**settings):
            self.run.add(name)
            result = operator(**settings)
            assert result == {"FINISHED"}, f"{name}: {result}"

        return call

    def tried(self, name: str, **settings) -> None:
        """Run it where it may need a window or have nothing to do: it works, or refuses in plain words."""
        import bpy

        self.run.add(name)
        try:
            getattr(bpy.ops.stormfield, name)(**settings)
        except RuntimeError as refusal:
            assert "Traceback" not in str(refusal), refusal

    @staticmethod
    def registered() -> set[str]:
        import bpy

        return {name for name in dir(bpy.ops.stormfield) if not name.startswith("_")}


def walk(op: Operators, stormfield) -> None:
    """One session of work."""
    import bpy

    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 2
    op.storm_merge()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)  # with a UV layer
    ball = bpy.context.object
    op.add_field()
    op.key_lambda()
    for place, kind in (((0, 0, 1), "vortex_ccw"), ((1, 0, 0), "saddle")):
        scene.cursor.location = place
        op.place_element(kind=kind)
    op.place_bifurcation(kind="appear_sink")
    op.remove_element()
    op.move_element(direction="UP")
    op.element_preset(preset="CYCLONE")
    op.draw_element(type="streamline")
    op.finish_drawing()
    op.remove_element()
    bpy.ops.object.empty_add(location=(0, 1, 0))
    bpy.context.view_layer.objects.active = ball
    op.add_elements()
    settings = ball.stormfield
    settings.solve.samples = 3
    op.solve()
    settings.elements[0].radius *= 1.1
    op.solve()  # from the first one
    op.fix_normals()
    op.fill_parts()
    op.tried("leave_out_parts")  # every part has an element
    op.tried("transfer_field")  # the mesh is the one that was solved
    op.tried("select_faults")
    bpy.ops.object.mode_set(mode="OBJECT")
    op.subdivide_mesh(times=1)
    op.solve_on_density()
    settings.solve.solve_on = "MESH"
    op.solve()
    bake = settings.bake
    bake.use_exr = bake.use_vdb = bake.use_morse = True
    bake.resolution = "256"
    op.bake()
    op.use_baked_caches()
    op.bring_caches()
    op.clean_caches()
    op.apply_material(material="lava")
    op.analyze()
    op.tried("cancel_weakest")  # whether a pair can be cancelled depends on the field
    for name in ("cancel_pair", "simplify", "move_edit", "remove_edit"):
        op.tried(name)
    op.analyze()
    op.analyze_lambda()
    op.update_markers()
    op.morse_sets()
    op.refine_morse()
    settings.analysis.mcg.active = 0
    op.refine_set()
    settings.analysis.ecg.active = 0
    op.streamlines()
    op.pathlines()
    op.select_entity()
    op.go_to_entity()
    for name in ("cancel_job", "show_graph", "keep_entity"):
        op.tried(name)  # nothing runs, and there is no window
    op.add_preset(name="")  # with a name it would write among the settings of whoever runs this
    op.forget_analysis()
    op.remove_field()


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]))
    except BaseException:
        import traceback

        traceback.print_exc()
        sys.stdout.flush()
        os._exit(1)
    os._exit(0)  # bpy 4.5 may never return from its destructors
