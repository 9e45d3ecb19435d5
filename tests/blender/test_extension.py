# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip installs as artists install it: built by Blender's tool, put into a repository, enabled, used, disabled."""

import os
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("bpy")
ROOT = Path(__file__).parents[2]
BUILDER = ROOT / "scripts" / "build_extension.py"


sys.path.insert(0, str(ROOT / "scripts"))
import build_wheels  # noqa: E402  (a script, not a package)

PLATFORM = "linux-x64"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel as scripts/build_wheels.py packs it, around the core that this Python has."""
    import importlib.util

    found = importlib.util.find_spec("stormfield_native")
    if found is None:
        pytest.skip("stormfield_native is not built for this Python")
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    folder = tmp_path_factory.mktemp("wheel")
    return build_wheels.pack(Path(found.origin), build_wheels.PLATFORMS[PLATFORM], python, folder)


@pytest.fixture(scope="module")
def extension(wheel, tmp_path_factory):
    output = tmp_path_factory.mktemp("extension")
    done = subprocess.run(
        [sys.executable, str(BUILDER), str(wheel), "--output", str(output)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = output.iterdir()
    assert done.stdout.split() == [str(built)]
    return built


def test_the_zip_holds_the_addon_and_as_wheels_the_core_and_libraries(extension, wheel):
    packed = zipfile.ZipFile(extension)
    names = packed.namelist()
    wanted = {"blender_manifest.toml", "__init__.py", "operators/solve.py", "model/design.schema.json", "cli/bake.py"}
    wanted |= {"assets/stormfield.blend", "assets/blender_assets.cats.txt", "ui/preset_pictures/cyclone.png"}
    assert wanted <= set(names)
    wheels = sorted(name.removeprefix("wheels/").split("-")[0] for name in names if name.endswith(".whl"))
    libraries = [library.split("==")[0].replace("-", "_").lower() for library in build_extension_libraries()]
    assert wheels == sorted([*libraries, "stormfield_native"])
    assert packed.read(f"wheels/{wheel.name}") == wheel.read_bytes()  # unchanged
    assert {"LICENSE", "licenses/README.md"} <= set(names)
    assert not [name for name in names if "__pycache__" in name or name == "__main__.py"]
    assert extension.stat().st_size < 40_000_000


def build_extension_libraries():
    import build_extension

    return build_extension.libraries()


def test_wheels_carry_the_licences_of_what_is_in_them(wheel):
    with zipfile.ZipFile(wheel) as packed:
        names = {name.rpartition("/")[2] for name in packed.namelist() if "/licenses/" in name}
        (metadata,) = (packed.read(name).decode() for name in packed.namelist() if name.endswith("/METADATA"))
    assert names == {"LICENSE", *(path.name for path in (ROOT / "licenses").iterdir())}
    assert all(f"License-File: {name}" in metadata for name in names)


NEEDS = " 0x0000000000000001 (NEEDED)             Shared library: [{}]\n"
SYMBOL = "   {}: 0000000000001000   100 FUNC    GLOBAL DEFAULT   {} {}\n"


def test_what_a_linux_wheel_must_not_need_is_found():
    fine = SYMBOL.format(1, "UND", "cos@GLIBC_2.2.5 (2)") + SYMBOL.format(2, 12, "PyInit_stormfield_native")
    assert build_wheels.faults_of(NEEDS.format("libm.so.6"), fine) == []
    assert build_wheels.faults_of(NEEDS.format("libtbb.so.12"), fine) == ["needs libtbb.so.12"]
    newer = fine + SYMBOL.format(3, "UND", "hypot@GLIBC_2.35 (3)")
    assert build_wheels.faults_of("", newer) == ["needs GLIBC_2.35"]
    (fault,) = build_wheels.faults_of("", fine + SYMBOL.format(4, 12, "_ZN3tbb6detail1aE"))
    assert fault.startswith("exports ")
    assert "RPATH" in build_wheels.faults_of(" 0x1d (RUNPATH)   Library runpath: [/home/me]\n", fine)[0]


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
        for name in ("jsonschema", "markdown_it", "matplotlib", "netCDF4", "pygments", "scipy", "xarray"):
            sys.modules[name] = None  # neither Blender's own Python nor the zip has them
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
