# SPDX-License-Identifier: GPL-3.0-or-later
"""The first steps of `make` on systems that lack something: what they do, and what they say."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: Programs that every Debian has.
TOOLS = ("bash", "sh", "env", "cat", "dirname", "ls", "mkdir", "sed", "sha256sum", "tail", "touch", "tee", "ln", "cp")

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="scripts of Debian and Ubuntu")


@pytest.fixture
def project(tmp_path):
    """A copy of the scripts, and a search path without any Python but a python3 that no Blender exists for."""
    folder = tmp_path / "project"
    (folder / "scripts").mkdir(parents=True)
    for name in ("environments.sh", "step.sh"):
        shutil.copy(ROOT / "scripts" / name, folder / "scripts" / name)
    shutil.copy(ROOT / "pyproject.toml", folder)
    (folder / "bin").mkdir()
    for tool in TOOLS:
        (folder / "bin" / tool).symlink_to(shutil.which(tool))
    return folder


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


def version(number):
    """A stand-in for Python: answers the question for its version, and makes environments that note their packages."""
    return f"""case "$*" in
*version_info*) case "$*" in *"!= '{number}'"*) exit 0;; *) exit 1;; esac;;
*"-m venv"*) mkdir -p "$3/bin"; cp "$0" "$3/bin/python";;
*"-m pip"*) echo "$*" >> "$NOTES"; exit "${{PIP_STATUS:-0}}";;
"- "*) cat >/dev/null; touch "$2/requirements.txt" "$2/requirements-blender.txt";;
esac"""


def environments(project, word, **variables):
    notes = project / "notes"
    return subprocess.run(
        [project / "scripts" / "environments.sh", word],
        env={"PATH": str(project / "bin"), "NOTES": str(notes), "HOME": str(project), **variables},
        capture_output=True,
        text=True,
        check=False,
    ), notes.read_text() if notes.exists() else ""


def uv(project, text):
    program(project / "build" / "uv" / "bin" / "uv", text)


def test_every_python_of_a_blender_gets_its_environment(project):
    for number in ("3.11", "3.13"):
        program(project / "bin" / f"python{number}", version(number))
    done, notes = environments(project, "create")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [".venv", ".venv-4.5"]
    assert "bpy==5.2.*" in notes and "bpy==4.5.*" in notes
    assert "installing Blender 5.2" in done.stderr and "minutes" in done.stderr
    assert environments(project, "list")[0].stdout.split() == [".venv", ".venv-4.5"]


def test_a_system_without_such_a_python_gets_one_through_uv(project):
    uv(project, f'mkdir -p "$UV_PYTHON_INSTALL_DIR/cpython-3.13.9-linux/bin"\n'
                f'cp "{project}/downloaded" "$UV_PYTHON_INSTALL_DIR/cpython-3.13.9-linux/bin/python3.13"')  # fmt: skip
    program(project / "downloaded", version("3.13"))
    program(project / "bin" / "python3", version("3.12"))
    done, notes = environments(project, "create")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [".venv"] and "bpy==5.2.*" in notes
    assert "Python 3.13 comes into build/python" in done.stderr
    assert environments(project, "list")[0].stdout.split() == [".venv"]


def test_where_nothing_can_be_downloaded_one_command_is_named(project):
    uv(project, "echo 'error: failed to look up github.com' >&2; exit 2")
    done, _ = environments(project, "create")
    assert done.returncode == 1 and done.stdout == ""
    lines = done.stderr.splitlines()
    assert "failed to look up github.com" in done.stderr  # the reason
    assert lines[-2] == "It could not be downloaded. Please run this, and make again:"
    assert lines[-1].startswith("  ") and "3.13" in lines[-1]
    assert environments(project, "list")[0].returncode == 1


def test_packages_that_cannot_be_installed_end_the_build_with_the_log(project):
    program(project / "bin" / "python3.13", version("3.13"))
    done, _ = environments(project, "create", PIP_STATUS="1")
    assert done.returncode == 1
    assert "The whole log is build/environment.venv.log" in done.stderr
    assert not (project / ".venv" / ".stormfield").exists()  # tried again next time


def step(project, *words):
    return subprocess.run(
        [project / "scripts" / "step.sh", *words], env=os.environ, capture_output=True, text=True, check=False
    )


def test_a_step_says_what_it_does_and_keeps_what_it_prints(project):
    done = step(project, "walk", "walking: a minute", "sh", "-c", "echo one; echo two >&2")
    assert (done.returncode, done.stdout, done.stderr) == (0, "walking: a minute\n", "")
    assert (project / "build" / "walk.log").read_text() == "one\ntwo\n"


def test_a_step_that_fails_shows_the_end_of_its_log(project):
    done = step(project, "--live", "walk", "walking: a minute", "sh", "-c", "seq 100; exit 3")
    assert done.returncode == 3
    lines = done.stderr.splitlines()
    assert lines[0] == "61" and lines[-3:] == ["100", "The whole log is build/walk.log", "failed: walking: a minute"]


@pytest.fixture
def tools(project):
    """A project without CMake and Ninja, with a python3 whose pip brings them at version 4.0."""
    shutil.copy(ROOT / "scripts" / "build_tools.sh", project / "scripts")
    shutil.copy(ROOT / "CMakeLists.txt", project)
    for tool in ("head", "sort", "chmod"):
        (project / "bin" / tool).symlink_to(shutil.which(tool))
    program(
        project / "bin" / "python3",
        """case "$*" in
*"-m venv"*) mkdir -p "$3/bin"; cp "$0" "$3/bin/python";;
*"-m pip"*) echo "$*" >> "$NOTES"; [ -z "$OFFLINE" ] || exit 1
  for name in cmake ctest ninja; do
    echo "#!/bin/sh
echo cmake version 4.0.1" > "${0%/*}/$name"; chmod +x "${0%/*}/$name"
  done;;
esac""",
    )

    def run(**variables):
        notes = project / "notes"
        done = subprocess.run(
            [project / "scripts" / "build_tools.sh"],
            env={"PATH": str(project / "bin"), "NOTES": str(notes), **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        return done, notes.read_text() if notes.exists() else ""

    return run


def cmake(project, number):
    for name in ("cmake", "ninja"):
        program(project / "bin" / name, f"echo cmake version {number}")


@pytest.mark.parametrize("number", ["3.22.1", "3.9.6", None])
def test_a_cmake_that_is_too_old_or_missing_is_replaced(project, tools, number):
    """Ubuntu 22.04 has 3.22; the Makefile puts the new one first on PATH."""
    if number:
        cmake(project, number)
    done, notes = tools()
    assert done.returncode == 0, done.stderr
    assert "CMake and Ninja come into build/tools" in done.stdout and "cmake>=3.25 ninja" in notes
    found = sorted(path.name for path in (project / "build" / "tools" / "bin").iterdir())
    assert found == ["cmake", "ctest", "ninja"]  # no python3, which would be taken for the system's
    path = f"{project}/build/tools/bin:{project}/bin"
    said = subprocess.run(["cmake", "--version"], env={"PATH": path}, capture_output=True, text=True, check=True).stdout
    assert said == "cmake version 4.0.1\n"
    assert "export PATH := $(CURDIR)/build/tools/bin:$(PATH)" in (ROOT / "Makefile").read_text()
    assert tools()[1] == notes, "brought twice"


@pytest.mark.parametrize("number", ["3.25.0", "3.31.6", "4.2.0"])
def test_a_cmake_that_is_new_enough_is_kept(project, tools, number):
    cmake(project, number)
    done, notes = tools()
    assert (done.returncode, done.stdout, notes) == (0, "", "")


def test_without_a_network_the_message_says_what_to_install(project, tools):
    done, _ = tools(OFFLINE="yes")
    assert done.returncode == 1
    assert "Please install CMake 3.25 or newer and Ninja, and make again." in done.stderr
