# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip on a machine that has Blender and nothing else: `make test` builds it and names it in STORMFIELD_ZIP."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy")
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "scripts")]
import build_wheels  # noqa: E402  (a script, not a package)
from clean_machine import GIVEN, HOME, ROOT, CleanMachine, copy_blender, missing  # noqa: E402

ZIP = os.environ.get("STORMFIELD_ZIP")
pytestmark = pytest.mark.skipif(ZIP is None, reason="STORMFIELD_ZIP names no zip; make zip builds one")


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    if reason := missing():
        pytest.fail(f"no clean machine can be made here: {reason}")
    root = ROOT / "build" / "clean" / "root"
    done = subprocess.run([ROOT / "scripts" / "clean_root.sh", root], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    made = CleanMachine(root, *(tmp_path_factory.mktemp(name) for name in ("blender", "home", "given")))
    copy_blender(made.blender)
    shutil.copy(Path(__file__).with_name("walk.py"), made.given)
    shutil.copy(ZIP, made.given / "stormfield.zip")
    return made


def passes(done):
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_machine_has_nothing_of_the_build(machine):
    names = {path.name for path in machine.root.rglob("*.so*")}
    assert not [name for name in names if name.startswith(("libtbb", "libopenvdb", "libOpenImageIO", "libgomp"))]
    assert not list(machine.blender.glob("stormfield*")) and not (machine.blender / "jsonschema").exists()


def test_the_zip_is_small():
    assert Path(ZIP).stat().st_size <= 15_000_000


def test_one_zip_is_installed_used_and_leaves_nothing(machine):
    passes(machine.walk("install", f"{GIVEN}/stormfield.zip"))
    (field,) = machine.home.rglob("lambda-*/manifest.json")
    cache = f"{HOME}/{field.parent.relative_to(machine.home)}"
    passes(machine.walk("command", "info", cache, "--json", f"{HOME}/info.json"))
    shown = json.loads((machine.home / "info.json").read_text())
    assert shown["mesh"]["vertices"] == 162 and len(shown["lam"]) == 3
    passes(machine.walk("command", "bake", "--targets", "exr", "--frames", "1-1", "--resume"))
    assert machine.walk("command", "bake", "--targets", "nonsense").returncode == 2
    for data in written_data(machine.given):
        passes(machine.walk("data", f"{GIVEN}/{data.name}"))
    passes(machine.walk("uninstall"))


def written_data(folder):
    """Wind in the formats of NetCDF, and a surface that meshio reads."""
    import meshio
    import netCDF4

    latitude, longitude = np.arange(-90.0, 91.0, 10.0), np.arange(0.0, 360.0, 10.0)
    for format in ("NETCDF4", "NETCDF3_CLASSIC", "NETCDF3_64BIT_DATA"):
        path = folder / f"{format.lower()}.nc"
        with netCDF4.Dataset(path, "w", format=format) as file:
            file.createDimension("time", None)
            axes = (("lat", latitude, "degrees_north"), ("lon", longitude, "degrees_east"))
            for name, values, unit in axes:
                file.createDimension(name, len(values))
                file.createVariable(name, "f8", (name,))[:] = values
                file[name].units = unit
            time = file.createVariable("time", "f8", ("time",))
            time.setncatts({"units": "hours since 2000-02-27", "calendar": "noleap"})
            time[:] = [0.0, 24.0]
            for name, share in (("u10", 1.0), ("v10", 0.0)):
                wind = file.createVariable(name, "i2", ("time", "lat", "lon"), zlib=format == "NETCDF4", shuffle=True)
                wind.setncatts({"units": "m s-1", "scale_factor": 0.01})
                wind[:2] = share * 20.0 * np.cos(np.radians(latitude))[None, :, None] * np.ones((2, 1, len(longitude)))
        yield path
    path = folder / "square.vtu"
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    meshio.write_points_cells(
        path, corners, {"triangle": [[0, 1, 2], [0, 2, 3]]}, point_data={"wind": np.ones((4, 3)) * [1.0, 0.5, 0.0]}
    )
    yield path


def test_without_a_library_of_the_system_it_does_not_pass(machine, tmp_path):
    """The machine is the one that is described: what is hidden there is missing."""
    library = next(machine.root.rglob("libm.so.6"))
    blind = replace(machine, home=tmp_path, hidden=(f"/{library.relative_to(machine.root)}",))
    assert blind.walk("install", f"{GIVEN}/stormfield.zip").returncode != 0


def test_a_core_that_needs_a_library_the_machine_lacks_says_so_when_it_is_enabled(machine, tmp_path):
    wheel = wheel_that_needs(b"libz.so.9", tmp_path)
    builder = [sys.executable, ROOT / "scripts" / "build_extension.py", wheel, "--output", machine.given / "other"]
    built = subprocess.run(builder, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    home = tmp_path / "home"
    home.mkdir()
    done = replace(machine, home=home).walk("install", f"{GIVEN}/other/{Path(built.stdout.strip()).name}")
    assert done.returncode != 0
    assert "Stormfield: The compiled core needs the library libz.so.9, which this machine does not have" in done.stderr


def wheel_that_needs(library, folder):
    """This Python's wheel of the zip, with one of the names of libraries in it exchanged."""
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    with zipfile.ZipFile(ZIP) as extension:
        (name,) = (
            name
            for name in extension.namelist()
            if "stormfield_native-" in name and f"-cp{python.replace('.', '')}-" in name
        )
        with zipfile.ZipFile(extension.open(name)) as wheel:
            (module,) = (entry for entry in wheel.namelist() if entry.endswith(".so"))
            binary = wheel.read(module)
    assert binary.count(b"\0libm.so.6\0") == 1
    path = folder / module
    path.write_bytes(binary.replace(b"\0libm.so.6\0", b"\0" + library + b"\0"))
    return build_wheels.pack(path, build_wheels.PLATFORMS["linux-x64"], python, folder)
