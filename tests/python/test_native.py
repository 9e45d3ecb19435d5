# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled core is checked before use, and every fault has a clear message."""

import subprocess
import sys
import types

import pytest
import stormfield
from stormfield import native


@pytest.fixture
def fresh(monkeypatch):
    """Loads anew in the test, and again after it."""
    native.load.cache_clear()
    yield monkeypatch
    native.load.cache_clear()


def test_loads_and_hands_through():
    native.check()
    assert native.load().__version__ == stormfield.__version__
    assert native.TriangleMesh is native.load().TriangleMesh
    with pytest.raises(AttributeError, match="no_such_thing"):
        _ = native.no_such_thing


def test_missing(fresh):
    class Nothing:
        def find_spec(self, name, path=None, target=None):
            if name == native.MODULE:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    fresh.delitem(sys.modules, native.MODULE)
    fresh.setattr(sys, "meta_path", [Nothing(), *sys.meta_path])
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    with pytest.raises(native.NativeError, match=rf"missing: .* Python {python}\. Install the zip"):
        native.check()


def test_wrong_version(fresh):
    fresh.setitem(sys.modules, native.MODULE, types.SimpleNamespace(__version__="9.9.9"))
    with pytest.raises(native.NativeError, match=r"version 9\.9\.9, Stormfield is version"):
        native.check()


def test_unloadable(tmp_path):
    suffix = "import importlib.machinery as m; print(m.EXTENSION_SUFFIXES[0])"
    ending = subprocess.run([sys.executable, "-c", suffix], capture_output=True, text=True, check=True).stdout.strip()
    (tmp_path / f"stormfield_native{ending}").write_bytes(b"not a library")
    code = f"import sys; sys.path[:0] = [{str(tmp_path)!r}]; from stormfield import native; native.check()"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "cannot be loaded" in run.stderr and "Install the zip" in run.stderr


@pytest.mark.parametrize(
    ("reason", "said"),
    [
        ("undefined symbol: _ZN3tbb6detail2r127get_thread_reference_vertexE", "import bpy before stormfield"),
        ("undefined symbol: PyUnicode_AsUTF8", "belongs to another Python"),
        ("file too short", "cannot be loaded"),
        ("libtbb.so.12: cannot open shared object file: No such file", "needs the library libtbb.so.12"),
        ("/lib/libm.so.6: version `GLIBC_2.35' not found (required by x)", "needs GLIBC_2.35"),
    ],
)
def test_import_faults_say_the_cure(fresh, reason, said):
    def broken(name):
        raise ImportError(reason)

    fresh.setattr(native.importlib, "import_module", broken)
    with pytest.raises(native.NativeError, match=said):
        native.check()


def test_blender_comes_first():
    """In a process that has bpy, loading the core first would break bpy; we import bpy before it."""
    code = (
        "import importlib.util, sys; has = importlib.util.find_spec('bpy') is not None\n"
        "from stormfield import native; native.check(); assert not has or 'bpy' in sys.modules; print('fine')"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "fine" in run.stdout, run.stderr
