# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing that the add-on does needs a package that neither Blender nor the zip has."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("bpy")
SCRIPT = Path(__file__).with_name("every_operator.py")


def test_every_module_and_operator_does_with_what_blender_and_the_zip_have(tmp_path, native):
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(tmp_path)], capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == 0 and "EVERY OPERATOR" in done.stdout, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr


def test_a_package_that_is_missing_is_found(tmp_path):
    """The hiding itself works: what needs a development package fails."""
    code = (
        f"import sys; sys.path.insert(0, {str(SCRIPT.parent)!r}); import every_operator; every_operator.hide_packages()"
    )
    env = {**os.environ, "PYTHONPATH": str(SCRIPT.parent)}
    for name, works in (("jsonschema", False), ("hypothesis", False), ("fastjsonschema", True), ("numpy", True)):
        done = subprocess.run(
            [sys.executable, "-c", f"{code}; import {name}"], capture_output=True, text=True, check=False, env=env
        )
        assert (done.returncode == 0) == works, (name, done.stderr)


def test_without_its_core_the_addon_registers_and_says_what_is_missing():
    """The preferences can say it only then; importing the add-on must not load the core."""
    code = """
import os, sys
import bpy

class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name == "stormfield_native":
            raise ImportError("libz.so.9: cannot open shared object file: No such file or directory")

sys.meta_path.insert(0, Refuse())
import stormfield
stormfield.register()
print("REGISTERED", flush=True)
os._exit(0)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "REGISTERED" in done.stdout, done.stderr
    assert "Stormfield: The compiled core needs the library libz.so.9" in done.stderr
