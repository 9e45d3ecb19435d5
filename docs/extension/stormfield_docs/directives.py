# SPDX-License-Identifier: GPL-3.0-or-later
"""Directives: tables of settings and operators, and the order of folders."""

import json
import math
from collections.abc import Sequence
from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from . import addon, arrows


class Settings(SphinxDirective):
    """```{settings} GROUP```, or the name of an operator, with the names of the settings in its body."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        groups = {**addon.operator_settings(), **addon.settings()}
        group = groups.get(self.arguments[0])
        if group is None:
            raise self.error(
                f"there is no property group or operator {self.arguments[0]}; there are {', '.join(groups)}"
            )
        names = " ".join(self.content).split()
        unknown = [name for name in names if name not in group]
        if unknown:
            raise self.error(f"{self.arguments[0]} has no {', '.join(unknown)}; it has {', '.join(group)}")
        listed = nodes.definition_list(classes=["settings"])
        for name in names:
            setting = group[name]
            body: list[nodes.Node] = [nodes.paragraph(text=sentence(setting.description))]
            if setting.items:
                body.append(_choices(setting.items))
            listed += _entry(self, setting.anchor, setting.label, facts(setting), body)
        return [listed]


class Operators(SphinxDirective):
    """```{operators}``` with the names of the operators in its body."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        known = addon.operators()
        listed = nodes.definition_list(classes=["settings"])
        for name in " ".join(self.content).split():
            if name not in known:
                raise self.error(f"there is no operator stormfield.{name}; there are {', '.join(known)}")
            operator = known[name]
            body = [nodes.paragraph(text=sentence(operator.description))]
            listed += _entry(self, operator.anchor, operator.label, f"bpy.ops.stormfield.{name}", body)
        return [listed]


class Arrows(SphinxDirective):
    """```{arrows} PART```: who may include or import whom, from the tables of tests/layering, drawn and listed."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        self.env.note_dependency(str(arrows.TEST))
        try:
            drawn, rows = arrows.picture(self.arguments[0]), arrows.table(self.arguments[0])
        except (KeyError, ValueError) as error:
            raise self.error(str(error)) from error
        return [
            nodes.raw("", drawn, format="html"),
            _table(("folder", "may use, with all that these use"), rows, code=2),
        ]


class Schema(SphinxDirective):
    """```{schema} PART```: the keys of a part of the design's JSON schema."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        schema = json.loads((addon.ADDON / "model" / "design.schema.json").read_text(encoding="utf-8"))
        part = {**schema["$defs"], **schema["properties"]}.get(self.arguments[0], {})
        rows = [(name, _said(each)) for name, each in part.get("properties", {}).items()]
        if not rows:
            raise self.error(f"the schema of a design has no part {self.arguments[0]} with keys")
        return [_table(("key", "value"), rows, code=1)]


DIRECTIVES = {"settings": Settings, "operators": Operators, "arrows": Arrows, "schema": Schema}


def _said(part: dict[str, Any]) -> str:
    """What a value of the schema may be, in words."""
    if "enum" in part:
        return "one of " + ", ".join(part["enum"])
    kind = {"number": "number", "integer": "whole number", "boolean": "true or false", "string": "text"}
    words = [kind.get(part.get("type", ""), "list" if part.get("type") == "array" else "vector [x, y, z]")]
    if part.get("type") == "array":
        words = ["list of vectors" if "$ref" in part["items"] else "list of numbers"]
    for key, sign in (("exclusiveMinimum", "above"), ("minimum", "from"), ("maximum", "to")):
        if key in part:
            words.append(f"{sign} {part[key]:g}")
    description = part.get("description")
    return " ".join(words) + (f". {description}" if description else "")


def sentence(text: str) -> str:
    """Tooltips end without a full stop, as Blender asks; a page has one."""
    return text if not text or text.endswith((".", "!", "?")) else text + "."


def facts(setting: addon.Setting) -> str:
    """Range and default, as far as they help."""
    said = []
    if setting.kind in {"Float", "Int"}:
        low, high = _number(setting, setting.lowest), _number(setting, setting.highest)
        if low and high:
            said.append(f"{low} to {high}")
        elif low:
            said.append(f"at least {low}")
        said.append(f"default {_number(setting, setting.default)}")
    elif setting.kind == "Bool":
        said.append("default on" if setting.default else "default off")
    elif setting.kind == "Enum" and isinstance(setting.default, str):
        said.append(f"default {setting.default}")
    return ", ".join(said)


def _number(setting: addon.Setting, value: float | None) -> str:
    if value is None:
        return ""
    if "degrees" in setting.description:
        return f"{math.degrees(value):g}°"
    return f"{value:g}"


def _entry(directive: SphinxDirective, anchor: str, label: str, said: str, body: list[nodes.Node]) -> nodes.Node:
    term = nodes.term("", "", nodes.strong(text=label), ids=[anchor], names=[anchor])
    directive.state.document.note_explicit_target(term)
    if said:
        term += nodes.Text("  ")
        term += nodes.inline(text=said, classes=["setting-facts"])
    return nodes.definition_list_item("", term, nodes.definition("", *body))


def _choices(items: tuple[tuple[str, str], ...]) -> nodes.Node:
    listed = nodes.bullet_list()
    for label, text in items:
        listed += nodes.list_item(
            "", nodes.paragraph("", "", nodes.strong(text=label), nodes.Text(f": {sentence(text)}"))
        )
    return listed


def _table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]], code: int = 0) -> nodes.Node:
    """The first `code` columns are names of the program."""
    group = nodes.tgroup(cols=len(heads))
    group += [nodes.colspec(colwidth=1 if i == 0 else 3) for i in range(len(heads))]
    group += nodes.thead("", _row(heads))
    group += nodes.tbody("", *(_row(row, code) for row in rows))
    return nodes.table("", group)


def _row(cells: tuple[str, ...], code: int = 0) -> nodes.Node:
    entries = []
    for column, text in enumerate(cells):
        inner = nodes.literal(text=text) if column < code and text != "nothing" else nodes.Text(text)
        entries.append(nodes.entry("", nodes.paragraph("", "", inner)))
    return nodes.row("", *entries)
