# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension: addon/ and one wheel of the compiled core per Python, in one zip.

    python scripts/build_extension.py [WHEEL...] [--output out] [--blender-ext PATH]

WHEEL    wheels of stormfield as `pip wheel` makes them, one per Python and platform; without any they are made here
         for every environment of `make`. Blender unpacks all wheels of an extension into one folder of its own, so
         only the compiled core is taken from them: the Python package is the extension itself.
Libraries that Blender does not have (LIBRARIES) are bundled beside it as their authors built them.
The zip is made and checked by Blender's own tool, blender_ext.py, which ships with the bpy wheel and needs no Blender.
"""

import argparse
import base64
import hashlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon"
CORE = "stormfield_native"
#: Bundled as they are on PyPI, with what they need: igraph lays graphs out.
LIBRARIES = ("igraph==1.0.0", "texttable==1.7.0")
#: Blender's platform → pip's, for the libraries.
PIP_PLATFORMS = {
    "linux-x64": "manylinux_2_28_x86_64",
    "windows-x64": "win_amd64",
    "windows-arm64": "win_arm64",
    "macos-x64": "macosx_11_0_x86_64",
    "macos-arm64": "macosx_11_0_arm64",
}
#: Wheel platform tags by their beginning → Blender's platform.
PLATFORMS = {
    ("manylinux", "x86_64"): "linux-x64",
    ("linux", "x86_64"): "linux-x64",
    ("win", "amd64"): "windows-x64",
    ("win", "arm64"): "windows-arm64",
    ("macosx", "x86_64"): "macos-x64",
    ("macosx", "arm64"): "macos-arm64",
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheels", nargs="*", type=Path, help="wheels of stormfield, one per Python and platform")
    parser.add_argument("--output", type=Path, default=Path("out"), help="folder of the zip")
    parser.add_argument("--blender-ext", type=Path, help="Blender's blender_ext.py; found beside bpy when not given")
    arguments = parser.parse_args()
    wheels = arguments.wheels or make_wheels()
    print(build(wheels, arguments.output, arguments.blender_ext or find_blender_ext()))


def make_wheels() -> list[Path]:
    """One wheel per Python environment of `make`, linked to its finished core where there is one."""
    listed = subprocess.run([ROOT / "scripts" / "environments.sh", "list"], capture_output=True, text=True, check=True)
    core = ROOT / "build" / "core"
    options = ["-C", f"cmake.define.STORMFIELD_CORE_DIR={core}"] if (core / "StormfieldCore.cmake").exists() else []
    wheels = []
    for environment in listed.stdout.split():
        with tempfile.TemporaryDirectory() as temporary:
            pip = [ROOT / environment / "bin" / "python", "-m", "pip", "wheel", "--quiet", "--no-deps"]
            subprocess.run([*pip, "--no-build-isolation", *options, "-w", temporary, "."], cwd=ROOT, check=True)
            wheel = next(Path(temporary).glob("stormfield-*.whl"))
            folder = ROOT / "build" / "wheels"
            folder.mkdir(parents=True, exist_ok=True)
            wheels.append(Path(shutil.copy(wheel, folder)))
    return wheels


def build(wheels: list[Path], output: Path, tool: Path) -> Path:
    """The extension's zip in `output`."""
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        source = Path(temporary) / "stormfield"
        shutil.copytree(ADDON, source, ignore=shutil.ignore_patterns("__pycache__"))
        cores = [core_wheel(wheel, source / "wheels") for wheel in wheels]
        platforms = sorted({platform_of(wheel) for wheel in cores})
        libraries = [path for platform in platforms for path in library_wheels(platform, source / "wheels")]
        write_manifest(source / "blender_manifest.toml", platforms, {*cores, *libraries})
        run(tool, "validate", str(source))
        run(tool, "build", "--source-dir", str(source), "--output-dir", str(output))
        manifest = tomllib.loads((source / "blender_manifest.toml").read_text(encoding="utf-8"))
    return output / f"{manifest['id']}-{manifest['version']}.zip"


def core_wheel(wheel: Path, folder: Path) -> Path:
    """A wheel named after the core, with nothing but the core in it and the libraries bundled with it."""
    folder.mkdir(exist_ok=True)
    version, *tags = wheel.stem.split("-")[1:]
    name = f"{CORE}-{version}-{'-'.join(tags)}"
    info = f"{CORE}-{version}.dist-info"
    with zipfile.ZipFile(wheel) as given, zipfile.ZipFile(folder / f"{name}.whl", "w", zipfile.ZIP_DEFLATED) as core:
        files = {n: given.read(n) for n in given.namelist() if n.startswith(CORE) or n.split("/")[0].endswith(".libs")}
        if not any(n.startswith(CORE) for n in files):
            sys.exit(f"{wheel}: has no {CORE} in it; build it with pip wheel")
        old = next(n.rsplit("/", 1)[0] for n in given.namelist() if n.endswith(".dist-info/WHEEL"))
        files[f"{info}/WHEEL"] = given.read(f"{old}/WHEEL")
        files[f"{info}/METADATA"] = (
            f"Metadata-Version: 2.1\nName: {CORE}\nVersion: {version}\nLicense: GPL-3.0-or-later\n"
            "Summary: Compiled core of Stormfield\n"
        ).encode()
        record = "".join(f"{n},sha256={digest(data)},{len(data)}\n" for n, data in sorted(files.items()))
        files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
        for member, data in sorted(files.items()):
            entry = zipfile.ZipInfo(member)  # no time stamps: equal input gives equal wheels
            entry.external_attr = 0o644 << 16
            core.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return folder / f"{name}.whl"


def library_wheels(platform: str, folder: Path) -> list[Path]:
    """The wheels of LIBRARIES for a platform, unmodified, in `folder`; a pure one serves all platforms."""
    with tempfile.TemporaryDirectory() as temporary:
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:", "-d", temporary]
        run_quietly([*pip, "--python-version", "3.11", "--platform", PIP_PLATFORMS[platform], *LIBRARIES])
        return [Path(shutil.copy(wheel, folder)) for wheel in sorted(Path(temporary).glob("*.whl"))]


def digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def platform_of(wheel: Path) -> str:
    tag = wheel.stem.split("-")[-1].split(".")[0]
    for (start, end), platform in PLATFORMS.items():
        if tag.startswith(start) and tag.endswith(end):
            return platform
    sys.exit(f"{wheel.name}: platform {tag} is unknown to Blender")


def write_manifest(path: Path, platforms: list[str], wheels: set[Path]) -> None:
    """Name wheels and platforms before the first table."""
    lines = [
        "platforms = [{}]".format(", ".join(f'"{platform}"' for platform in platforms)),
        "wheels = [{}]".format(", ".join(f'"./wheels/{wheel.name}"' for wheel in sorted(wheels))),
    ]
    head, table, rest = path.read_text(encoding="utf-8").partition("\n[")
    path.write_text(head + "\n".join(lines) + "\n" + table + rest, encoding="utf-8")


def find_blender_ext() -> Path:
    for folder in {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}:
        for found in Path(folder).glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    sys.exit("blender_ext.py was not found; run this with a Python that has bpy, or name it with --blender-ext")


def run(tool: Path, *arguments: str) -> None:
    run_quietly([sys.executable, str(tool), *arguments])


def run_quietly(command: list[str]) -> None:
    """Run a command and say what it said only when it failed."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)


if __name__ == "__main__":
    main()
