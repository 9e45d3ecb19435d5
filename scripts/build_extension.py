# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension, one zip for each platform: addon/, wheels of the compiled core, and libraries.

    python scripts/build_extension.py [WHEEL...] [--output out] [--blender-ext PATH]

WHEEL    wheels of stormfield_native as scripts/build_wheels.py makes them, one per Python and platform; without any
         those in out/wheels, and where there are none they are built for Linux first.
All wheels are bundled unchanged: ours, and as their authors built them those of LIBRARIES, which Blender does not have.
The zips are made and checked by Blender's own tool blender_ext.py, which ships with the bpy wheel and needs no Blender.
"""

import argparse
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon"
CORE = "stormfield_native"
#: Bundled as they are on PyPI, with what they need: igraph lays graphs out (later ones have twice the size), click is
#: the command line's, fastjsonschema checks designs, meshio reads surfaces (rich, for its messages, needs nothing of
#: its own here), cftime knows the calendars of wind and currents; NETCDF, with what it imports, reads them: netCDF4
#: would take more than all the rest.
LIBRARIES = (
    *("igraph==0.11.8", "texttable==1.7.0", "click==8.5.1", "fastjsonschema==2.22.3", "meshio==5.3.5", "rich==15.0.0"),
    *("cftime==1.6.6.1", "fsspec==2026.9.0", "packaging==26.4"),
)
#: The extra of pyproject.toml that names the readers of NetCDF, so that the tests run with what is bundled.
NETCDF = "blender"
#: Blender's platform → tags of wheels that serve it, as pip names them.
PLATFORMS = {
    "linux-x64": "manylinux_2_28_x86_64",
    "windows-x64": "win_amd64",
    "macos-arm64": "macosx_11_0_arm64",
}
#: Tags of older wheels that serve it as well.
ALSO = {"linux-x64": ("manylinux_2_17_x86_64",)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheels", nargs="*", type=Path, help=f"wheels of {CORE}, one per Python and platform")
    parser.add_argument("--output", type=Path, default=Path("out"), help="folder of the zips")
    parser.add_argument("--blender-ext", type=Path, help="Blender's blender_ext.py; found beside bpy when not given")
    arguments = parser.parse_args()
    wheels = arguments.wheels or built_wheels()
    for path in build(wheels, arguments.output, arguments.blender_ext or find_blender_ext()):
        print(path)


def built_wheels() -> list[Path]:
    """The wheels of this version in out/wheels; for Linux they are built where there are none."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    folder = ROOT / "out" / "wheels"
    if not any(folder.glob(f"{CORE}-{version}-*.whl")):
        subprocess.run([sys.executable, str(ROOT / "scripts" / "build_wheels.py"), "--output", str(folder)], check=True)
    return sorted(folder.glob(f"{CORE}-{version}-*.whl"))


def build(wheels: list[Path], output: Path, tool: Path) -> list[Path]:
    """The extension's zips in `output`, one for each platform of the wheels."""
    output.mkdir(parents=True, exist_ok=True)
    by_platform: dict[str, list[Path]] = {}
    for wheel in wheels:
        by_platform.setdefault(platform_of(wheel), []).append(wheel)
    return [build_one(platform, cores, output, tool) for platform, cores in sorted(by_platform.items())]


def build_one(platform: str, cores: list[Path], output: Path, tool: Path) -> Path:
    with tempfile.TemporaryDirectory() as temporary:
        source = Path(temporary) / "stormfield"
        shutil.copytree(ADDON, source, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "LICENSE", source)
        shutil.copytree(ROOT / "licenses", source / "licenses")
        add_assets(source)
        (source / "wheels").mkdir()
        bundled = {Path(shutil.copy(wheel, source / "wheels")) for wheel in cores}
        bundled |= set(library_wheels(platform, source / "wheels"))
        write_manifest(source / "blender_manifest.toml", platform, bundled)
        run(tool, "validate", str(source))
        run(tool, "build", "--split-platforms", "--source-dir", str(source), "--output-dir", temporary)
        built = next(Path(temporary).glob("*.zip"))
        run(tool, "validate", str(built))
        return Path(shutil.copy(built, output))


def add_assets(source: Path) -> None:
    """The asset library, made by the oldest Blender that is here: newer ones read its files, but not the reverse."""
    oldest = ROOT / ".venv-4.5" / "bin" / "python"
    python = str(oldest) if oldest.exists() else sys.executable
    environment = {**os.environ, "PYTHONPATH": str(source.parent)}
    run_quietly([python, str(ROOT / "scripts" / "build_assets.py"), str(source / "assets")], environment)
    for leftover in source.rglob("__pycache__"):
        shutil.rmtree(leftover)


def libraries() -> tuple[str, ...]:
    """What is bundled, each with its version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return (*LIBRARIES, *project["optional-dependencies"][NETCDF])


def library_wheels(platform: str, folder: Path) -> list[Path]:
    """The wheels of the libraries for a platform, unmodified, in `folder`; a pure one serves all platforms."""
    with tempfile.TemporaryDirectory() as temporary:
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:", "-d", temporary]
        tags = [word for tag in (PLATFORMS[platform], *ALSO.get(platform, ())) for word in ("--platform", tag)]
        run_quietly([*pip, "--python-version", "3.11", *tags, *libraries()])
        return [Path(shutil.copy(wheel, folder)) for wheel in sorted(Path(temporary).glob("*.whl"))]


def platform_of(wheel: Path) -> str:
    """Blender's name for the platform of a wheel of the core."""
    name, *_, tag = wheel.stem.split("-")
    for platform, wanted in PLATFORMS.items():
        if name == CORE and tag == wanted:
            return platform
    sys.exit(
        f"{wheel.name}: is no wheel of {CORE} for {', '.join(PLATFORMS.values())}; scripts/build_wheels.py makes them"
    )


def write_manifest(path: Path, platform: str, wheels: set[Path]) -> None:
    """Name wheels and platform before the first table."""
    lines = [
        f'platforms = ["{platform}"]',
        "wheels = [{}]".format(", ".join(f'"./wheels/{wheel.name}"' for wheel in sorted(wheels))),
    ]
    head, table, rest = path.read_text(encoding="utf-8").partition("\n[")
    path.write_text(head + "\n" + "\n".join(lines) + "\n" + table + rest, encoding="utf-8")


def find_blender_ext() -> Path:
    for folder in {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}:
        for found in Path(folder).glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    sys.exit("blender_ext.py was not found; run this with a Python that has bpy, or name it with --blender-ext")


def run(tool: Path, *arguments: str) -> None:
    run_quietly([sys.executable, str(tool), *arguments])


def run_quietly(command: list[str], environment: dict[str, str] | None = None) -> None:
    """Run a command and say what it said only when it failed."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)


if __name__ == "__main__":
    main()
