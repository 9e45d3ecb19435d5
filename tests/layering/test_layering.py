"""The arrows of the architecture: who may include or import whom."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Each folder of native/ and what it may include besides itself.
NATIVE = {
    "base": [],
    "mesh": ["base"],
    "field": ["base", "mesh"],
    "tracing": ["base", "mesh", "field"],
    "maps": ["base", "mesh", "field", "tracing"],
    "morse": ["base", "mesh", "field", "tracing", "maps"],
    "topology": ["base", "mesh", "field", "tracing", "maps"],
    "streamlines": ["base", "mesh", "field", "tracing", "maps", "topology"],
    "tracking": ["base", "mesh", "field", "tracing", "maps", "topology"],
    "solver": ["base", "mesh", "field"],
    "design": ["base", "mesh", "field", "tracing", "solver"],
    "texture": ["base", "mesh", "field", "tracing"],
    "io": ["base", "mesh", "field"],
    "bindings": [
        *["base", "mesh", "field", "tracing", "maps", "morse", "topology", "streamlines", "tracking"],
        *["solver", "design", "texture", "io"],
    ],
}

# Parts of the add-on that run without Blender, and the parts they must not import.
WITHOUT_BLENDER = [
    *["model", "version.py", "work.py", "native.py", "solve.py", "cache", "analysis", "figures", "bake", "readers"],
]
BLENDER_PARTS = {"scene", "session", "properties", "operators", "ui", "shading", "presets", "handlers"}
# Blender's own Python modules are found through bpy; these files alone do that, and only inside functions.
MAY_ASK_BPY = {"cache/usd.py", "native.py"}


def forbidden_includes(text: str, folder: str) -> list[str]:
    """Includes of our own headers that `folder` may not use."""
    allowed = {folder, *NATIVE[folder]}
    return [path for path in re.findall(r'#include "([^"]+)"', text) if path.split("/")[0] not in allowed]


def imports(text: str) -> list[tuple[str, bool]]:
    """Imported modules as (dotted name relative to the package, is at module level)."""
    tree = ast.parse(text)
    top = set(map(id, tree.body))
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, id(node) in top) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            names = [base] if node.module else [base + alias.name for alias in node.names]
            found += [(name, id(node) in top) for name in names]
    return found


def foreign_details(text: str, folder: str) -> list[str]:
    """Includes of headers that only their own folder may use."""
    paths = re.findall(r'#include "([^"]+)"', text)
    return [path for path in paths if "/detail/" in path and path.split("/")[0] != folder]


def type_names(text: str) -> list[str]:
    """Classes, structs, enums and aliases that a source file defines at namespace scope outside unnamed namespaces.

    Text is read, not compiled: comments and strings go first, then what lies inside braces that open no namespace.
    """
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r'"(?:[^"\\\n]|\\.)*"', '""', text)
    text = re.sub(r"^\s*#.*(?:\\\n.*)*", "", text, flags=re.M)
    outside, depth, inside = [], [], 0  # depth: per open brace whether it is a named namespace
    start = 0
    for match in re.finditer(r"[{}]", text):
        head = text[start : match.start()]
        if not inside:
            outside.append(head)
        start = match.end()
        if match.group() == "{":
            named = re.search(r"namespace\s+[\w:]+\s*$", head) is not None and not inside
            depth.append(named)
            inside += not named
            if inside == 1 and not named:
                outside.append("{}")
        elif depth:
            inside -= not depth.pop()
    visible = "".join(outside)
    defined = re.findall(
        r"\b(?:class|struct|union|enum(?:\s+class)?)\s+(\w+)\s*(?:final\s*)?(?::[^:;{}][^;{}]*)?\{", visible
    )
    return defined + re.findall(r"\busing\s+(\w+)\s*=", visible)


def repeated_types(files: dict[str, str]) -> dict[str, list[str]]:
    """Type names that more than one file defines, with the files."""
    places: dict[str, list[str]] = {}
    for path, text in files.items():
        for name in type_names(text):
            places.setdefault(name, []).append(path)
    return {name: paths for name, paths in places.items() if len(paths) > 1}


@pytest.mark.parametrize("folder", NATIVE)
def test_native_includes_point_left(folder):
    for path in sorted((ROOT / "native" / folder).rglob("*")):
        if path.suffix in {".h", ".cpp"}:
            bad = forbidden_includes(path.read_text(), folder)
            assert not bad, f"{path.relative_to(ROOT)} includes {bad}; {folder} may include {NATIVE[folder]}"


@pytest.mark.parametrize("folder", NATIVE)
def test_details_stay_in_their_folder(folder):
    for path in sorted((ROOT / "native" / folder).rglob("*.[hc]*")):
        bad = foreign_details(path.read_text(), folder)
        assert not bad, f"{path.relative_to(ROOT)} includes {bad}"


def test_a_type_name_stands_once():
    # Two classes of one qualified name are undefined behaviour that no compiler reports.
    files = {str(p.relative_to(ROOT)): p.read_text() for p in sorted((ROOT / "native").rglob("*.[hc]*"))}
    assert not repeated_types(files)


def test_every_native_folder_is_listed():
    assert {p.name for p in (ROOT / "native").iterdir() if p.is_dir()} == set(NATIVE)


def test_pybind11_stays_in_bindings():
    for path in (ROOT / "native").rglob("*.*"):
        if path.parent.name != "bindings" and path.suffix in {".h", ".cpp"}:
            assert "pybind11" not in path.read_text(), path


def blender_free_files():
    for part in WITHOUT_BLENDER:
        path = ROOT / "addon" / part
        yield from [path] if path.is_file() else sorted(path.rglob("*.py"))


def test_blender_free_parts_do_not_import_blender():
    for path in blender_free_files():
        relative = path.relative_to(ROOT / "addon").as_posix()
        for name, top in imports(path.read_text()):
            if name.split(".")[0] in {"bpy", "mathutils", "gpu"}:
                assert relative in MAY_ASK_BPY and not top, f"addon/{relative} imports {name}"
            part = name.lstrip(".").split(".")[0]
            if name.startswith("."):
                assert part not in BLENDER_PARTS, f"addon/{relative} imports {name}"


def test_model_knows_neither_native_nor_blender():
    for path in (ROOT / "addon" / "model").rglob("*.py"):
        for name, _ in imports(path.read_text()):
            assert "native" not in name and "bpy" not in name, f"{path.name} imports {name}"


def test_the_native_module_has_one_door():
    for path in (ROOT / "addon").rglob("*.py"):
        if path.name == "native.py":
            continue
        for name, _ in imports(path.read_text()):
            assert name.split(".")[0] != "stormfield_native", f"{path.relative_to(ROOT)}: import it through native.py"


def test_addon_imports_are_relative():
    for path in (ROOT / "addon").rglob("*.py"):
        for name, _ in imports(path.read_text()):
            assert name.split(".")[0] != "stormfield", f"{path.relative_to(ROOT)}: {name}"


def test_the_checks_can_fail():
    assert forbidden_includes('#include "solver/constraint.h"\n', "mesh") == ["solver/constraint.h"]
    assert foreign_details('#include "morse/detail/exit_set.h"\n', "topology") == ["morse/detail/exit_set.h"]
    assert ("..operators", True) in imports("from ..operators import x")
    assert ("bpy", False) in imports("def f():\n    import bpy")


def test_the_check_of_type_names_can_fail():
    first = "namespace stormfield {\n/// struct Other {\nstruct Crossing {\n  struct Side { int a; };\n};\n}"
    second = "namespace stormfield {\nclass Crossing final : public Base<int> {\n};\nusing Row = int;\n}"
    unnamed = "namespace stormfield {\nnamespace {\nstruct Crossing {};\nenum class Side { Left };\n}\nclass Row;\n}"
    assert type_names(first) == ["Crossing"] and type_names(second) == ["Crossing", "Row"] and type_names(unnamed) == []
    assert repeated_types({"a.h": first, "b.h": second, "c.cpp": unnamed}) == {"Crossing": ["a.h", "b.h"]}
