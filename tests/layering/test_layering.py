# SPDX-License-Identifier: GPL-3.0-or-later
"""The arrows of the architecture: who may include or import whom."""

import ast
import itertools
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
    "edit": ["base", "mesh", "field", "tracing", "maps", "morse", "topology", "solver"],
    "design": ["base", "mesh", "field", "tracing", "solver"],
    "texture": ["base", "mesh", "field", "tracing"],
    "io": ["base", "mesh", "field"],
    "bindings": [
        *["base", "mesh", "field", "tracing", "maps", "morse", "topology", "streamlines", "tracking"],
        *["solver", "edit", "design", "texture", "io"],
    ],
}

# Each part of addon/, a file or a folder, and what it may import besides itself. Inner folders are parts of their own.
_PLAIN = ["model", "version", "work", "native"]
_DATA = [*_PLAIN, "solve", "edits", "cache", "analysis", "bake/task", "bake/targets", "bake", "readers", "compat"]
_SCENE = [*_DATA, "scene/read", "scene/nodes", "scene/write"]
_STATE = [*_SCENE, "session", "properties", "shading", "presets"]
_ALL = [
    *[*_STATE, "operators", "ui", "handlers", "manual", "preferences"],
    *["figures", "readers", "cli", "command", "assets"],
]
ADDON = {
    "model": [],
    "version": [],
    "work": [],
    "compat": [],
    "native": ["model", "version"],
    "solve": ["model", "version", "native"],
    "edits": [*_PLAIN],
    "cache": ["model", "version", "work", "native"],
    "analysis": [*_PLAIN, "cache"],
    "figures": [*_PLAIN, "cache", "analysis"],
    "readers": ["model", "version", "work", "native", "cache"],
    "bake/task": [*_PLAIN, "cache"],
    "bake/targets": [*_PLAIN, "cache", "bake/task"],
    "bake": [*_PLAIN, "solve", "edits", "cache", "bake/task", "bake/targets"],
    "scene/read": _DATA,
    "scene/nodes": [*_DATA, "scene/read"],
    "scene/write": [*_DATA, "scene/read", "scene/nodes"],
    "session": _SCENE,
    "properties": [*_SCENE, "session"],
    "shading": _SCENE,
    "presets": [*_SCENE, "shading"],
    "operators": _STATE,
    "ui": [*_STATE, "operators"],
    "handlers": [*_STATE, "operators", "ui"],
    "manual": [*_SCENE, "session", "properties"],
    "preferences": [*_STATE, "operators"],
    "assets": [],
    "cli": [*_SCENE, "figures", "readers"],
    "command": [*_SCENE, "figures", "readers", "cli"],
    "__init__": [*_ALL],
    "__main__": [*_ALL, "__init__"],
}
# Parts that run without Blender.
WITHOUT_BLENDER = [
    *["model", "version", "work", "native", "solve", "edits", "cache", "analysis", "figures", "readers"],
    *["bake/task", "bake/targets", "bake"],
]
# Blender's own Python modules are found through bpy; these files alone do that, and only inside functions.
MAY_ASK_BPY = {"cache/bundled.py", "native.py"}


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


def module_name(path: Path) -> str:
    """Dotted name of a file relative to addon/; of a package that of its folder, of the add-on itself __init__."""
    parts = path.relative_to(ROOT / "addon").with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


def part_of(module: str) -> str:
    """The innermost part of the add-on that a module belongs to."""
    names = module.split(".")
    prefixes = ["/".join(names[:count]) for count in range(len(names), 0, -1)]
    return next((prefix for prefix in prefixes if prefix in ADDON), names[0])


def imported_modules(module: str, is_package: bool, text: str, known: set[str]) -> set[str]:
    """The add-on's own modules that a module imports, also inside functions."""
    folder = module.split(".") if module != "__init__" else []
    if not is_package:
        folder = folder[:-1]
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level:
            source = [*folder[: len(folder) - node.level + 1], *(node.module or "").split(".")]
            source = [name for name in source if name]
            for alias in node.names:
                whole = ".".join([*source, alias.name])
                found.add(whole if whole in known else ".".join(source) or "__init__")
    return found


def import_graph(files: dict[str, tuple[bool, str]]) -> dict[str, set[str]]:
    """files: per module whether it is a package, and its text."""
    return {m: imported_modules(m, package, text, set(files)) for m, (package, text) in files.items()}


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Strongly connected components of more than one module (Tarjan 1972), and modules that import themselves."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []

    def visit(node: str) -> None:
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            component = set(stack[stack.index(node) :])
            del stack[stack.index(node) :]
            if len(component) > 1 or node in graph.get(node, ()):
                found.append(component)

    for node in graph:
        if node not in number:
            visit(node)
    return found


def forbidden_imports(graph: dict[str, set[str]]) -> list[tuple[str, str]]:
    """Imports between modules that the table of parts does not allow."""
    return [
        (module, other)
        for module, others in graph.items()
        for other in sorted(others)
        if part_of(other) not in (part_of(module), *ADDON.get(part_of(module), []))
    ]


def drawn_arrows(text: str) -> dict[str, set[str]]:
    """What each part may use by a drawing such as "a, b ← { c ← d | e }; all ← f": all that lies to its left."""
    tokens = re.findall(r"[\w/]+|[←,{}|;]", text)
    direct: dict[str, set[str]] = {}

    def chain(left: list[str]) -> list[str]:
        """Reads one chain up to its end; returns all its names."""
        names: list[str] = []
        while tokens and tokens[0] not in ";|}":
            term: list[str] = []
            while tokens and tokens[0] not in "←;|}":
                token = tokens.pop(0)
                if token == "{":
                    while tokens[0] != "}":
                        term += chain(left)
                        if tokens[0] == "|":
                            tokens.pop(0)
                    tokens.pop(0)
                elif token != ",":
                    term.append(token)
                    direct.setdefault(token, set()).update(left)
            if tokens and tokens[0] == "←":
                tokens.pop(0)
            names += term
            left = term
        return names

    while tokens:
        chain([])
        if tokens:
            tokens.pop(0)
    everything = set(direct) - {"all"}
    direct.pop("all", None)
    for name, uses in direct.items():
        if "all" in uses:
            uses.update(everything - {name})
            uses.remove("all")
    closure = {name: set(uses) for name, uses in direct.items()}
    for _ in closure:
        for uses in closure.values():
            uses.update(*(closure[used] for used in uses))
    return closure


def readme_arrows(folder: str) -> str:
    """The drawing of one folder in the map of the README: the lines below its name that are set in as far."""
    text = (ROOT / "README.md").read_text().split("## Map", 1)[1]
    lines = text.split(f"\n{folder}/", 1)[1].splitlines()[1:]
    inner = list(itertools.takewhile(lambda line: line.startswith(" " * 8), lines))
    return " ".join(line.strip() for line in inner)


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


def addon_files() -> dict[str, tuple[bool, str]]:
    paths = [
        path for path in (ROOT / "addon").rglob("*.py") if path.parent != ROOT / "addon" / "presets" / "stormfield"
    ]
    return {module_name(path): (path.name == "__init__.py", path.read_text()) for path in sorted(paths)}


def test_addon_imports_point_left():
    bad = forbidden_imports(import_graph(addon_files()))
    assert not bad, [
        f"{module} imports {other}; {part_of(module)} may not use {part_of(other)}" for module, other in bad
    ]


def test_no_module_imports_itself_by_way_of_others():
    assert not circles(import_graph(addon_files()))


def test_every_part_of_the_addon_is_listed():
    assert {part_of(module) for module in addon_files()} - {"scene"} == set(ADDON)
    top = {path.stem for path in (ROOT / "addon").iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
    assert top == {part.split("/")[0] for part in ADDON}


@pytest.mark.parametrize(("folder", "table"), [("native", NATIVE), ("addon", ADDON)])
def test_the_readme_draws_the_arrows_that_hold(folder, table):
    drawn = drawn_arrows(readme_arrows(folder))
    entry = {"__init__", "__main__"}
    assert drawn == {part: set(uses) - entry for part, uses in table.items() if part not in entry}


def test_blender_free_parts_do_not_import_blender():
    for path in sorted((ROOT / "addon").rglob("*.py")):
        if part_of(module_name(path)) not in WITHOUT_BLENDER:
            continue
        relative = path.relative_to(ROOT / "addon").as_posix()
        for name, top in imports(path.read_text()):
            if name.split(".")[0] in {"bpy", "mathutils", "gpu"}:
                assert relative in MAY_ASK_BPY and not top, f"addon/{relative} imports {name}"


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


def test_the_checks_of_python_imports_can_fail():
    files = {
        "scene.read.mesh": (False, "from ...operators import bake\nfrom ...model.errors import InputError"),
        "operators": (True, ""),
        "operators.bake": (False, "def f():\n    from ..scene.read import mesh"),
        "model.errors": (False, "from . import other"),
        "model": (True, ""),
        "scene.read": (True, ""),
    }
    graph = import_graph(files)
    assert graph["scene.read.mesh"] == {"operators.bake", "model.errors"} and graph["model.errors"] == {"model"}
    assert forbidden_imports(graph) == [("scene.read.mesh", "operators.bake")]
    assert circles(graph) == [{"scene.read.mesh", "operators.bake"}]
    assert circles({"a": {"b"}, "b": {"c"}, "c": set(), "d": {"d"}}) == [{"d"}]


def test_the_check_of_drawn_arrows_can_fail():
    drawn = drawn_arrows("a, b ← { c ← d | e }; e ← f; all ← g")
    assert drawn["d"] == {"a", "b", "c"} and drawn["e"] == {"a", "b"} and drawn["f"] == {"a", "b", "e"}
    assert drawn["g"] == set("abcdef") and drawn["a"] == set()
    assert drawn_arrows("a ← b ← c")["c"] != drawn_arrows("a ← b; a ← c")["c"]


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
