# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on says of itself, read from its sources: settings, operators, panels. Blender is not needed."""

import ast
import importlib.util
import sys
import types
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
ADDON = ROOT / "addon"


@dataclass(frozen=True)
class Setting:
    """One property: what the panel and its tooltip say."""

    group: str
    name: str
    kind: str  #: Float, Bool, Enum, ...
    label: str
    description: str
    default: Any = None
    lowest: float | None = None
    highest: float | None = None
    items: tuple[tuple[str, str], ...] = ()  #: (label, tooltip) of the choices

    @property
    def anchor(self) -> str:
        return anchor_of_setting(self.group, self.name)


@dataclass(frozen=True)
class Operator:
    name: str  #: as in bpy.ops.stormfield.NAME
    label: str
    description: str

    @property
    def anchor(self) -> str:
        return anchor_of_operator(self.name)


@dataclass
class _Recorded:
    """A setting, with the names of its parts in Blender's own record."""

    kind: str
    options: dict[str, Any] = field(default_factory=dict)
    function: None = None

    @property
    def keywords(self) -> dict[str, Any]:
        return self.options


def anchor_of_setting(group: str, name: str) -> str:
    return f"{group}-{name}".lower().replace("_", "-")


def anchor_of_operator(name: str) -> str:
    return f"operator-{name}".replace("_", "-")


@cache
def settings() -> dict[str, dict[str, Setting]]:
    """Every property of every group, in the order of the source: settings()[group][name]."""
    with _tree_package("stormfield_for_docs", blender=True):
        properties = importlib.import_module("stormfield_for_docs.properties")
        return {cls.__name__: _settings_of(cls) for cls in properties.CLASSES}


@cache
def operator_settings() -> dict[str, dict[str, Setting]]:
    """The settings of the operators themselves, in the panel Adjust Last Operation, by the operator's name."""
    found: dict[str, dict[str, Setting]] = {}
    for tree in _sources("operators"):
        lists = {ast.unparse(s.targets[0]): s.value for s in tree.body if isinstance(s, ast.Assign)}
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and _texts(node).get("bl_idname", "").startswith("stormfield."):
                name = _texts(node)["bl_idname"].partition(".")[2]
                found[name] = {}
                for key, call in ((s.target, s.annotation) for s in node.body if isinstance(s, ast.AnnAssign)):
                    if isinstance(call, ast.Call):
                        found[name][ast.unparse(key)] = _setting(name, ast.unparse(key), call, lists)
    return found


def _setting(group: str, name: str, call: ast.Call, lists: dict[str, ast.expr]) -> Setting:
    options: dict[str, Any] = {}
    for keyword in call.keywords:
        value = lists.get(keyword.value.id, keyword.value) if isinstance(keyword.value, ast.Name) else keyword.value
        with suppress(ValueError):  # computed: the page goes without
            options[str(keyword.arg)] = ast.literal_eval(value)
    return _described(group, name, ast.unparse(call.func).removesuffix("Property"), options)


@cache
def operators() -> dict[str, Operator]:
    """By the last part of their name."""
    found = {}
    for tree in _sources():
        for node in ast.walk(tree):
            if not isinstance(node, ast.ClassDef):
                continue
            texts = _texts(node)
            prefix, _, name = texts.get("bl_idname", "").partition(".")
            if prefix == "stormfield":
                found[name] = Operator(
                    name, texts.get("bl_label", name), " ".join((ast.get_docstring(node) or "").split())
                )
    return found


#: Settings that no panel draws although another group's setting of the same name is drawn.
HIDDEN = {("EntityList", "lam"), ("EntityList", "shown_field"), ("FieldProperties", "enabled")}


def shown(setting: Setting) -> bool:
    """Whether a panel or list draws it."""
    # Two panels draw settings whose names they build.
    built = setting.group == "AnalysisProperties" and setting.name.startswith("show_")
    built |= (setting.group, setting.name) in {("MorseProperties", "tau"), ("MorseProperties", "length")}
    hidden = setting.group == "EntityItem" or (setting.group, setting.name) in HIDDEN
    return built or (setting.name in names_in_panels() and not hidden)


@cache
def names_in_panels() -> frozenset[str]:
    """Properties that a panel, menu or list draws: the NAME of layout.prop(data, NAME) and of its relatives."""
    drawn = set()
    for tree in _sources("ui"):
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") in {"prop", "prop_search", "prop_enum"}:
                drawn |= {str(each.value) for each in node.args[1:2] if isinstance(each, ast.Constant)}
    return frozenset(drawn)


def command_group() -> Any:
    """The click group of the command line."""
    with _tree_package("stormfield_for_docs"):
        return importlib.import_module("stormfield_for_docs.cli").cli


def _sources(folder: str = "") -> Iterator[ast.Module]:
    for path in sorted((ADDON / folder).rglob("*.py")):
        yield ast.parse(path.read_text(encoding="utf-8"))


def _texts(node: ast.ClassDef) -> dict[str, str]:
    """The class attributes that are plain strings."""
    return {
        statement.targets[0].id: statement.value.value
        for statement in node.body
        if isinstance(statement, ast.Assign)
        and isinstance(statement.targets[0], ast.Name)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    }


def _settings_of(cls: type) -> dict[str, Setting]:
    recorded = cls.__annotations__.items()
    return {name: _described(cls.__name__, name, found.kind, found.options) for name, found in recorded}


def _described(group: str, name: str, kind: str, options: dict[str, Any]) -> Setting:
    items = options.get("items", ())
    default = options.get("default")
    if kind == "Enum" and isinstance(default, str):
        default = {item[0]: item[1] for item in items}.get(default, default)
    return Setting(
        group=group,
        name=name,
        kind=kind,
        label=options.get("name", name),
        description=options.get("description", ""),
        default=default,
        lowest=options.get("min"),
        highest=options.get("max"),
        items=tuple((item[1], item[2]) for item in items),
    )


# Blender, as far as classes and properties are defined with it --------------------------------------------------------


class _Types(types.ModuleType):
    def __getattr__(self, name: str) -> type:
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


class _Props(types.ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda **options: _Recorded(name.removesuffix("Property"), options)


#: Blender's other modules, of which functions use what definitions only name.
OTHERS = ("blf", "bmesh", "bpy_extras", "bpy_extras.io_utils", "gpu", "gpu_extras", "gpu_extras.batch", "mathutils",
          "mathutils.bvhtree")  # fmt: skip


def _blender() -> dict[str, types.ModuleType]:
    bpy = types.ModuleType("bpy")
    bpy.types, bpy.props = _Types("bpy.types"), _Props("bpy.props")  # type: ignore[attr-defined]
    return {"bpy": bpy, "bpy.types": bpy.types, "bpy.props": bpy.props, **{name: _Types(name) for name in OTHERS}}


@contextmanager
def _tree_package(name: str, blender: bool = False) -> Iterator[None]:
    """addon/ of this tree as a package of that name; what is imported meanwhile is forgotten afterwards."""
    before = dict(sys.modules)
    if blender:
        sys.modules.update(_blender())
    spec = importlib.util.spec_from_file_location(name, ADDON / "__init__.py", submodule_search_locations=[str(ADDON)])
    assert spec is not None and spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    try:
        yield
    finally:
        standing_in = {"bpy", *OTHERS}
        for each in [each for each in sys.modules if {each.split(".")[0], each} & {name, *standing_in}]:
            del sys.modules[each]
        sys.modules.update({key: module for key, module in before.items() if {key.split(".")[0], key} & standing_in})
