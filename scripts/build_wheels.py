# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the wheels of stormfield_native that run on any machine of a platform, for every Python that Blender has.

    python scripts/build_wheels.py [--platform linux-x64 ...] [--python 3.11 ...] [--output out/wheels]

The compiler is Clang from ziglang, which has the libraries of every platform: nothing but libc and its companions is
linked, oneTBB and libc++ are inside and hidden, and Linux wheels run from glibc 2.28 on. All platforms are built here;
those that are not this machine's are built and not run.

What it needs it brings into build/wheels: the tools from PyPI at the versions below, oneTBB and Python's headers from
Debian's packages (debian_fetch.sh). The first platform takes about ten minutes on two cores, each further one five.
"""

import argparse
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = ROOT / "build" / "wheels"
MODULE = "stormfield_native"
TOOLS = (
    "ziglang==0.17.1",
    "pybind11==3.1.0",
    "cmake>=3.25",
    "ninja",
    "auditwheel==6.8.2",
    "macholib==1.16.4",
    "pefile==2024.8.26",
)
#: Python that Blender 4.5, Blender 5.2 and Debian's Blender have, and the release of Debian that has its headers.
PYTHONS = {"3.11": "bookworm", "3.13": "trixie", "3.14": "sid"}
TBB_SHA256 = "7e9111b8bb59c8800bf6d0b06afe7b0891937443d2dae1ee1101c8e2ede6a7ef"  # 2021.8.0, of bookworm
#: Libraries of the system that a Linux wheel may need.
NEEDED = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2"}
MAX_GLIBC = (2, 28)
MAX_BYTES = 6_000_000


@dataclass(frozen=True)
class Platform:
    """A platform by Blender's name for it."""

    target: str  #: zig's
    tag: str  #: of the wheel
    suffix: str  #: of the module's file name; {python} is 311
    link: tuple[str, ...] = ()  #: options of the linker


PLATFORMS = {
    "linux-x64": Platform(
        "x86_64-linux-gnu.2.28",
        "manylinux_2_28_x86_64",
        ".cpython-{python}-x86_64-linux-gnu.so",
        ("-Wl,-s", f"-Wl,--version-script={ROOT / 'native/bindings/exports.map'}"),
    ),
    "macos-arm64": Platform(
        "aarch64-macos.11.0",
        "macosx_11_0_arm64",
        ".cpython-{python}-darwin.so",
        ("-Wl,-undefined,dynamic_lookup", "-s"),
    ),
    "windows-x64": Platform("x86_64-windows-gnu", "win_amd64", ".cp{python}-win_amd64.pyd", ("-s",)),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--platform", action="append", choices=PLATFORMS, help="default: linux-x64")
    parser.add_argument("--python", action="append", choices=PYTHONS, help="default: all")
    parser.add_argument("--output", type=Path, default=ROOT / "out" / "wheels", help="folder of the wheels")
    arguments = parser.parse_args()
    for name in arguments.platform or ["linux-x64"]:
        for wheel in build(name, arguments.python or list(PYTHONS), arguments.output):
            print(wheel)


def build(name: str, pythons: list[str], output: Path) -> list[Path]:
    """The wheels of one platform, in `output`."""
    output.mkdir(parents=True, exist_ok=True)
    platform, folder = PLATFORMS[name], WORK / name
    make_commands(platform, folder / "bin")
    build_tbb(platform, folder)
    build_core(platform, folder)
    wheels = []
    for python in pythons:
        module = build_module(name, folder, python)
        wheel = pack(module, platform, python, output)
        if name == "linux-x64":
            check_linux(wheel)
        else:
            check_other(wheel)
        wheels.append(wheel)
    return wheels


# Tools ----------------------------------------------------------------------------------------------------------------


def tool(name: str) -> str:
    """A command of the tools' environment, which is made on first use."""
    environment = WORK / "tools"
    stamp, wanted = environment / "stamp", "\n".join(TOOLS)
    if not stamp.exists() or stamp.read_text() != wanted:
        say("fetching the compiler (400 MB unpacked)")
        run([sys.executable, "-m", "venv", environment])
        run([environment / "bin" / "python", "-m", "pip", "install", "--quiet", *TOOLS])
        stamp.write_text(wanted)
    return str(environment / "bin" / name)


def make_commands(platform: Platform, folder: Path) -> None:
    """Compiler and archiver of the platform as commands that CMake can call."""
    folder.mkdir(parents=True, exist_ok=True)
    zig = f'"{tool("python")}" -m ziglang'
    # zig adds checks for undefined behaviour to optimised code too unless it is told not to.
    flags = f"-target {platform.target} -fno-sanitize=undefined"
    commands = {"cc": f"cc {flags}", "c++": f"c++ {flags}", "ar": "ar", "ranlib": "ranlib"}
    for name, command in commands.items():
        path = folder / name
        path.write_text(f'#!/bin/sh\nexec {zig} {command} "$@"\n')
        path.chmod(0o755)
    # oneTBB names its version in a resource, for which there is no place in a static library.
    resources = folder / "windres"
    resources.write_text(f'#!/bin/sh\nfor output; do :; done\nexec {zig} cc {flags} -c -x c /dev/null -o "$output"\n')
    resources.chmod(0o755)


def cmake(source: Path, build_folder: Path, platform: Platform, *options: str, target: str = "all") -> None:
    """Configure and build."""
    toolchain = ROOT / "cmake" / "zig.cmake"
    tools = build_folder.parent / "bin"
    # ccache takes the commands for other compilers whenever they lie elsewhere or were written again.
    os.environ["CCACHE_COMPILERCHECK"] = f"string:{TOOLS[0]} {platform.target}"
    os.environ["CCACHE_COMPILERTYPE"] = "clang"
    settings = {
        "CMAKE_TOOLCHAIN_FILE": toolchain,
        "STORMFIELD_ZIG_TARGET": platform.target,
        "STORMFIELD_ZIG_TOOLS": tools,
        "CMAKE_MAKE_PROGRAM": tool("ninja"),
        "CMAKE_BUILD_TYPE": "Release",
    }
    defined = [f"-D{key}={value}" for key, value in settings.items()]
    run([tool("cmake"), "-S", source, "-B", build_folder, "-G", "Ninja", *defined, *options], quiet=True)
    run([tool("cmake"), "--build", build_folder, "--target", target], quiet=True)


# Parts ----------------------------------------------------------------------------------------------------------------


def build_tbb(platform: Platform, folder: Path) -> None:
    """oneTBB as a static library whose symbols stay inside the module."""
    if (folder / "tbb-installed").exists():
        return
    say("building oneTBB")
    source = tbb_source()
    options = ("-DBUILD_SHARED_LIBS=OFF", "-DTBB_TEST=OFF", "-DTBB_STRICT=OFF", "-DTBBMALLOC_BUILD=OFF")
    cmake(
        source,
        folder / "tbb",
        platform,
        *options,
        "-DCMAKE_POLICY_VERSION_MINIMUM=3.5",
        "-DCMAKE_CXX_VISIBILITY_PRESET=hidden",
        "-DCMAKE_POSITION_INDEPENDENT_CODE=ON",
        f"-DCMAKE_INSTALL_PREFIX={folder / 'tbb-installed'}",
        target="install",
    )


def tbb_source() -> Path:
    """The unpacked source of oneTBB at the one version that is built."""
    folder = WORK / "source"
    if not any(folder.glob("oneTBB-*")):
        run([ROOT / "scripts" / "debian_fetch.sh", "source", "onetbb", folder, "bookworm"])
        archive = next(path for path in folder.glob("onetbb_*.orig.tar.*") if path.suffix != ".asc")
        if hashlib.sha256(archive.read_bytes()).hexdigest() != TBB_SHA256:
            sys.exit(f"{archive.name}: is another oneTBB than the one that was checked; update TBB_SHA256 after a look")
        with tarfile.open(archive) as packed:
            packed.extractall(folder, filter="data")
    return next(folder.glob("oneTBB-*"))


def build_core(platform: Platform, folder: Path) -> None:
    say("compiling the core")
    cmake(ROOT, folder / "core", platform, "-DSTORMFIELD_PYTHON=OFF", f"-DTBB_DIR={tbb_config(folder)}", eigen())


def build_module(name: str, folder: Path, python: str) -> Path:
    """The compiled module for one Python."""
    say(f"compiling the module for Python {python}")
    platform, digits = PLATFORMS[name], python.replace(".", "")
    link = list(platform.link)
    if name == "windows-x64":
        link.append(str(import_library(folder, python)))
    build_folder = folder / f"module-{digits}"
    cmake(
        ROOT,
        build_folder,
        platform,
        f"-DSTORMFIELD_CORE_DIR={folder / 'core'}",
        f"-DSTORMFIELD_PYTHON_HEADERS={';'.join(map(str, python_headers(name, python)))}",
        f"-DSTORMFIELD_MODULE_SUFFIX={platform.suffix.format(python=digits)}",
        f"-DSTORMFIELD_MODULE_LINK_OPTIONS={';'.join(link)}",
        f"-Dpybind11_DIR={pybind11()}",
        f"-DTBB_DIR={tbb_config(folder)}",
        eigen(),
    )
    return next((build_folder / "native" / "bindings").glob(f"{MODULE}.*"))


def tbb_config(folder: Path) -> Path:
    return next((folder / "tbb-installed").rglob("TBBConfig.cmake")).parent


def eigen() -> str:
    """Headers alone, so that the machine's own serve every platform."""
    return f"-DEigen3_DIR={next(Path('/usr/share/eigen3').rglob('Eigen3Config.cmake')).parent}"


def pybind11() -> str:
    return run([tool("python"), "-m", "pybind11", "--cmakedir"]).strip()


# Python's headers -----------------------------------------------------------------------------------------------------


def python_package(python: str) -> Path:
    """Debian's development files of a Python, unpacked."""
    folder = WORK / f"python-{python}"
    if not (folder / "usr").exists():
        run([ROOT / "scripts" / "debian_fetch.sh", "deb", f"libpython{python}-dev", folder, PYTHONS[python]])
        run(["dpkg-deb", "-x", next(folder.glob("libpython*.deb")), folder])
    return folder / "usr"


def python_headers(name: str, python: str) -> list[Path]:
    """Folders of the headers."""
    usr = python_package(python)
    if name == "linux-x64":
        return [usr / "include" / f"python{python}", usr / "include"]
    config = windows_config(python) if name == "windows-x64" else macos_config(python)
    # Python.h takes the pyconfig.h beside it, whatever folders are searched.
    folder = WORK / f"python-{python}-{name}"
    shutil.copytree(usr / "include" / f"python{python}", folder, dirs_exist_ok=True)
    (folder / "pyconfig.h").write_bytes(config)
    return [folder, usr / "include"] if name == "macos-arm64" else [folder]


def macos_config(python: str) -> bytes:
    """pyconfig.h: what Linux says of a 64 bit Unix, but for the type of thread keys; what else differs no header asks
    for."""
    return f"""#include <x86_64-linux-gnu/python{python}/pyconfig.h>
#undef PTHREAD_KEY_T_IS_COMPATIBLE_WITH_INT
#undef SIZEOF_PTHREAD_KEY_T
#define SIZEOF_PTHREAD_KEY_T 8
""".encode()


def windows_config(python: str) -> bytes:
    """The pyconfig.h that python.org's Windows builds use, from Python's own source."""
    folder = WORK / f"python-{python}-source"
    config = folder / "pyconfig.h"
    if not config.exists():
        run([ROOT / "scripts" / "debian_fetch.sh", "source", f"python{python}", folder, PYTHONS[python]])
        with tarfile.open(next(path for path in folder.glob("python*.orig.tar.*") if path.suffix != ".asc")) as packed:
            members = [m for m in packed.getmembers() if re.fullmatch(r"[^/]+/PC/pyconfig\.h(\.in)?", m.name)]
            text = packed.extractfile(members[0]).read()
        config.write_bytes(text)
        for archive in folder.glob("python3*"):
            archive.unlink()
    return config.read_bytes()


def import_library(folder: Path, python: str) -> Path:
    """What the linker needs to know of python3XX.dll: its name and those of what it exports."""
    digits = python.replace(".", "")
    library = folder / f"libpython{digits}.a"
    if not library.exists():
        static = next(python_package(python).rglob(f"libpython{python}.a"))
        names = sorted(set(re.findall(r" [TDBRV] (_?Py\w+)$", run(["nm", "-g", "--defined-only", static]), re.M)))
        definition = folder / f"python{digits}.def"
        definition.write_text(f"LIBRARY python{digits}.dll\nEXPORTS\n" + "".join(f"  {name}\n" for name in names))
        zig = [tool("python"), "-m", "ziglang", "dlltool", "-m", "i386:x86-64"]
        run([*zig, "-d", definition, "-l", library])
    return library


# Wheels ---------------------------------------------------------------------------------------------------------------


def pack(module: Path, platform: Platform, python: str, output: Path) -> Path:
    """A wheel with the module and the licences of what is in it."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    abi = f"cp{python.replace('.', '')}"
    info = f"{MODULE}-{version}.dist-info"
    tag = f"{abi}-{abi}-{platform.tag}"
    files = {module.name: module.read_bytes()}
    stubs = module.with_name(f"{MODULE}.pyi")
    if stubs.exists():
        files[stubs.name] = stubs.read_bytes()
    licences = {path.name: path.read_bytes() for path in [ROOT / "LICENSE", *sorted((ROOT / "licenses").iterdir())]}
    files |= {f"{info}/licenses/{name}": text for name, text in licences.items()}
    files[f"{info}/METADATA"] = "\n".join(
        [
            "Metadata-Version: 2.4",
            f"Name: {MODULE}",
            f"Version: {version}",
            "Summary: Compiled core of Stormfield: design and analysis of vector fields on surfaces",
            "License-Expression: GPL-3.0-or-later AND MPL-2.0 AND BSD-3-Clause AND Apache-2.0 WITH LLVM-exception"
            " AND Apache-2.0",
            *(f"License-File: {name}" for name in licences),
            f"Requires-Python: =={python}.*",
            "",
        ]
    ).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: stormfield\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = "".join(f"{name},sha256={digest(data)},{len(data)}\n" for name, data in sorted(files.items()))
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = output / f"{MODULE}-{version}-{tag}.whl"
    temporary = wheel.with_suffix(".part")
    with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, data in sorted(files.items()):
            entry = zipfile.ZipInfo(name)  # no time stamps: equal input gives equal wheels
            entry.external_attr = 0o644 << 16
            packed.writestr(entry, data, zipfile.ZIP_DEFLATED)
    temporary.replace(wheel)
    return wheel


def digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def check_linux(wheel: Path) -> None:
    """Ends with a message unless the wheel keeps what its tag promises."""
    module = unpacked(wheel)
    faults = faults_of(run(["readelf", "-dW", module]), run(["readelf", "--dyn-syms", "-W", module]))
    if module.stat().st_size > MAX_BYTES:
        faults.append(f"the module has {module.stat().st_size} bytes, more than {MAX_BYTES}")
    shown = run([tool("auditwheel"), "show", wheel])
    found = re.findall(r"manylinux_(\d+)_(\d+)_x86_64", shown)
    if not found or min((int(a), int(b)) for a, b in found) > MAX_GLIBC:
        faults.append(f"auditwheel does not find it fit for manylinux_2_28: {' '.join(shown.split())}")
    if faults:
        sys.exit(f"{wheel.name}: " + "; ".join(faults))


#: Libraries of the other systems that a wheel may need: what every macOS and every Windows 10 has, and Python.
SYSTEM = re.compile(r"/usr/lib/libSystem\.B\.dylib|KERNEL32\.dll|api-ms-win-crt-[\w-]+\.dll|python3\d+\.dll", re.I)
#: Prints the libraries that a module needs, a line each.
LIST_LIBRARIES = """
import sys
if sys.argv[1].endswith(".so"):
    from macholib.MachO import MachO
    names = {name for header in MachO(sys.argv[1]).headers for _, _, name in header.walkRelocatables()}
else:
    import pefile
    names = {entry.dll.decode() for entry in pefile.PE(sys.argv[1]).DIRECTORY_ENTRY_IMPORT}
print("\\n".join(sorted(names)))
"""


def check_other(wheel: Path) -> None:
    """Ends with a message if the module needs a library that not every machine of its system has."""
    module = unpacked(wheel)
    needed = run([tool("python"), "-c", LIST_LIBRARIES, module]).split()
    strange = [name for name in needed if not SYSTEM.fullmatch(name)]
    if strange or module.stat().st_size > MAX_BYTES:
        sys.exit(f"{wheel.name}: needs {', '.join(strange) or 'nothing strange'}, has {module.stat().st_size} bytes")


def unpacked(wheel: Path) -> Path:
    """The module of a wheel, as a file."""
    folder = WORK / "checked"
    shutil.rmtree(folder, ignore_errors=True)
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(folder)
    return next(path for path in folder.glob(f"{MODULE}.*") if path.suffix in (".so", ".pyd"))


def faults_of(dynamic: str, symbols: str) -> list[str]:
    """What a module needs or shows and must not, from readelf's -d and --dyn-syms."""
    faults = []
    if strange := set(re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic)) - NEEDED:
        faults.append(f"needs {', '.join(sorted(strange))}")
    if re.search(r"\((RPATH|RUNPATH)\)", dynamic):
        faults.append("names folders of the machine that built it (RPATH)")
    newest = max((tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", symbols)), default=(0,))
    if newest > MAX_GLIBC:
        faults.append(f"needs GLIBC_{'.'.join(map(str, newest))}")
    if "GLIBCXX" in symbols:
        faults.append("needs the system's libstdc++")
    # Defined and not local: columns are value, size, type, binding, visibility, section, name.
    exports = re.findall(r"^\s*\d+: \w+\s+\w+ \w+\s+(?:GLOBAL|WEAK)\s+\w+\s+\d+ (\S+)$", symbols, re.M)
    if exports != [f"PyInit_{MODULE}"]:
        faults.append(f"exports {', '.join(exports[:5]) or 'nothing'}, not PyInit_{MODULE} alone")
    return faults


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def run(command: list, *, quiet: bool = False) -> str:
    """The command's output; ends with what it said when it fails."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-6000:]}{done.stderr[-6000:]}")
    return "" if quiet else done.stdout


if __name__ == "__main__":
    main()
