# SPDX-License-Identifier: GPL-3.0-or-later
"""A machine with this Python's Blender and nothing of Stormfield's build: a system unpacked by scripts/clean_root.sh,
seen through a namespace of its own, without a network."""

import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
#: Where the machine has what is shown to it.
BLENDER, GIVEN, HOME = "/opt/blender", "/opt/given", "/home/artist"


def missing() -> str:
    """Why no clean machine can be made here, or nothing."""
    done = subprocess.run(["unshare", "-rmn", "true"], capture_output=True, text=True, check=False)
    return done.stderr.strip() if done.returncode else ""


@dataclass(frozen=True)
class CleanMachine:
    """Runs walk.py; `home` is the user's folder and stays from one run to the next."""

    root: Path
    blender: Path  #: a folder for PYTHONPATH with bpy and what it needs
    home: Path
    given: Path  #: the folder with walk.py and the zip
    hidden: tuple[str, ...] = field(default=())  #: files of the root that are not there

    def walk(self, *words: str) -> subprocess.CompletedProcess:
        shown = [(self.blender, BLENDER), (self.given, GIVEN), (self.home, HOME)]
        if sys.base_prefix != "/usr":
            shown.append((Path(sys.base_prefix), sys.base_prefix))
        lines = ["set -e", f"cd {shlex.quote(str(self.root))}"]
        for source, place in shown:
            inside = shlex.quote(f".{place}")
            lines.append(f"mkdir -p {inside}; mount --rbind {shlex.quote(str(source))} {inside}")
        lines += [f"mount --rbind /{name} {name}" for name in ("dev", "proc")]
        lines.append("mount -t tmpfs tmpfs tmp")
        lines += [f"mount --bind /dev/null {shlex.quote(f'.{path}')}" for path in self.hidden]
        python = Path(sys.base_prefix) / "bin" / f"python{sys.version_info.major}.{sys.version_info.minor}"
        environment = {"HOME": HOME, "PATH": "/usr/bin:/bin", "PYTHONPATH": BLENDER, "LANG": "C.UTF-8"}
        settings = [f"{key}={value}" for key, value in environment.items()]
        inside = ["env", "-i", *settings, "bash", "-c", f'cd {HOME}; exec "$@"', "-", str(python), f"{GIVEN}/walk.py"]
        lines.append(f"exec chroot . {shlex.join([*inside, *words])}")
        return subprocess.run(
            ["unshare", "-rmn", "bash", "-c", "\n".join(lines)],
            capture_output=True,
            text=True,
            check=False,
            timeout=600,
        )


def copy_blender(folder: Path) -> None:
    """The distribution bpy and those that it requires, and nothing else of this environment."""
    wanted, copied = ["bpy"], set()
    while wanted:
        name = wanted.pop()
        if name in copied:
            continue
        copied.add(name)
        distribution = metadata.distribution(name)
        for file in distribution.files:
            if file.parts[0] != ".." and "__pycache__" not in file.parts:
                link_or_copy(Path(distribution.locate_file(file)), folder / file)
        requirements = [Requirement(text) for text in distribution.requires or ()]
        wanted += [item.name for item in requirements if item.marker is None or item.marker.evaluate({"extra": ""})]


def link_or_copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        target.hardlink_to(source.resolve())
    except OSError:  # another disk
        shutil.copy2(source, target)
