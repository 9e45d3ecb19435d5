# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip installs as artists install it: built by Blender's tool, put into a repository, enabled, used, disabled."""

import os
import subprocess
import sys
import sysconfig
import textwrap
import zipfile
from pathlib import Path

import pytest
from stormfield.version import VERSION

pytest.importorskip("bpy")
ROOT = Path(__file__).parents[2]
BUILDER = ROOT / "scripts" / "build_extension.py"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel as `pip wheel` names it, around the core that this Python has."""
    import importlib.util

    found = importlib.util.find_spec("stormfield_native")
    if found is None:
        pytest.skip("stormfield_native is not built for this Python")
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    path = tmp_path_factory.mktemp("wheel") / f"stormfield-{VERSION}-{tag}-{tag}-{platform}.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(found.origin, Path(found.origin).name)
        archive.writestr("stormfield/__init__.py", "")
        archive.writestr(f"stormfield-{VERSION}.dist-info/WHEEL", f"Wheel-Version: 1.0\nTag: {tag}-{tag}-{platform}\n")
    return path


@pytest.fixture(scope="module")
def extension(wheel, tmp_path_factory):
    output = tmp_path_factory.mktemp("extension")
    done = subprocess.run(
        [sys.executable, str(BUILDER), str(wheel), "--output", str(output)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return output / f"stormfield-{VERSION}.zip"


def test_the_zip_holds_the_addon_and_as_wheels_the_core_and_libraries(extension):
    names = zipfile.ZipFile(extension).namelist()
    assert {"blender_manifest.toml", "__init__.py", "operators/solve.py", "model/design.schema.json"} <= set(names)
    wheels = sorted(name.split("-")[0] for name in names if name.endswith(".whl"))
    assert wheels == ["wheels/igraph", "wheels/stormfield_native", "wheels/texttable"]
    assert not [name for name in names if "__pycache__" in name or name.startswith(("cli/", "figures/", "readers/"))]


def test_versions_agree():
    import tomllib

    import stormfield

    manifest = tomllib.loads((ROOT / "addon" / "blender_manifest.toml").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert manifest["version"] == project["project"]["version"] == stormfield.__version__
    assert len(manifest["tagline"]) <= 64


def test_imports_of_the_package_are_relative():
    for path in (ROOT / "addon").rglob("*.py"):
        text = path.read_text()
        assert "import stormfield\n" not in text and "from stormfield." not in text, path


def test_it_installs_works_and_writes_nothing_into_itself(extension, tmp_path):
    script = textwrap.dedent(f"""
        import bpy, pathlib, sys
        for name in ("click", "h5netcdf", "jsonschema", "meshio", "rich", "scipy", "xarray"):
            sys.modules[name] = None  # Blender's own Python does not have them
        repository = bpy.context.preferences.extensions.repos.new(
            name="Test", module="test", custom_directory={str(tmp_path / "repository")!r}, source="USER")
        bpy.ops.extensions.package_install_files(filepath={str(extension)!r}, repo="test", enable_on_install=True)
        import addon_utils
        assert addon_utils.check("bl_ext.test.stormfield")[1], "not enabled"
        folder = pathlib.Path({str(tmp_path / "repository" / "stormfield")!r})
        before = sorted(str(p) for p in folder.rglob("*") if "__pycache__" not in str(p))
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
        bpy.ops.stormfield.add_field()
        bpy.ops.stormfield.place_element(kind="vortex_ccw")
        bpy.context.object.stormfield.solve.samples = 3
        assert bpy.ops.stormfield.solve() == {{"FINISHED"}}
        assert "sf_advection" in bpy.context.object.evaluated_get(
            bpy.context.evaluated_depsgraph_get()).data.attributes
        assert bpy.ops.stormfield.morse_sets() == {{"FINISHED"}}
        assert bpy.ops.stormfield.analyze() == {{"FINISHED"}}
        assert len(bpy.context.object.stormfield.analysis.ecg_tree.nodes) > 1
        assert list(pathlib.Path({str(tmp_path)!r}).glob("**/site-packages/igraph")), "igraph was not unpacked"
        scene = bpy.context.scene
        scene.frame_end = 2
        assert bpy.ops.stormfield.bake() == {{"FINISHED"}}
        assert bpy.ops.stormfield.apply_material(material="lava") == {{"FINISHED"}}
        assert before == sorted(str(p) for p in folder.rglob("*") if "__pycache__" not in str(p))
        addon_utils.disable("bl_ext.test.stormfield")
        assert not hasattr(bpy.types.Object, "stormfield")
        print("INSTALLED", flush=True)
        import os
        os._exit(0)  # bpy 4.5 may never return from its destructors
    """)
    home = {"BLENDER_USER_RESOURCES": str(tmp_path / "user"), "HOME": str(tmp_path), "PATH": os.environ["PATH"]}
    # A clean environment: the extension brings its own core.
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=home, check=False, timeout=300
    )
    assert "INSTALLED" in done.stdout, done.stdout + done.stderr
