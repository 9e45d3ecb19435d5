# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON of users checked by the schemas beside this file: one line that says where, what is wrong, and the cure.

check(data, "stormfield.edits/1", "edits")      # by edits.schema.json
"""

import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import InputError
from .words import Json

if TYPE_CHECKING:
    from fastjsonschema import JsonSchemaValueException

#: A remark that names what lies at a place of the JSON; empty where it has no name.
Remark = Callable[[Json, Sequence[str | int]], str]


def check(
    data: Json,
    schema: str,
    noun: str,
    remark: Remark = lambda _data, _place: "",
    earlier: Sequence[str] = (),
) -> None:
    """Raises InputError unless the data say that they are of this schema or an earlier one, and are of this one. noun:
    its file, NOUN.schema.json."""
    from fastjsonschema import JsonSchemaValueException

    found = data.get("schema") if isinstance(data, dict) else None
    if found != schema and found not in earlier:
        raise InputError(f'schema: is {found!r}: {_article(noun)} says "schema": "{schema}"')
    try:
        _validator(noun)(data)
    except JsonSchemaValueException as error:
        place = tuple(int(part) if part.isdigit() else part for part in error.path[1:])  # the first is "data"
        path = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")
        raise InputError(f"{path or noun}: {_describe(error, noun)}{remark(data, place)}") from None


def _article(noun: str) -> str:
    return "a file of edits" if noun == "edits" else f"a {noun}"


@cache
def _validator(noun: str) -> Callable[[Json], Json]:
    import fastjsonschema

    text = (Path(__file__).parent / f"{noun}.schema.json").read_text(encoding="utf-8")
    # The identifier would be taken for an address to load from.
    schema = {key: value for key, value in json.loads(text).items() if key != "$id"}
    return fastjsonschema.compile(schema, use_default=False)


def _describe(error: "JsonSchemaValueException", noun: str) -> str:
    """The validator's finding as a fault and its cure, short enough for one line."""
    shown = json.dumps(error.value, ensure_ascii=False)
    shown = shown if len(shown) <= 40 else shown[:37] + "..."
    rule = error.rule_definition
    match error.rule:
        case "enum":
            return f"is {shown}: use one of {', '.join(rule)}"
        case "const":
            return f"is {shown}: write {rule}"
        case "required":
            missing = [name for name in rule if name not in error.value]
            return f"{missing[0]} is missing: add it"
        case "additionalProperties":
            known = error.definition["properties"]
            unknown = [name for name in error.value if name not in known]
            return f"{unknown[0]} is not known: remove it, or use one of {', '.join(known)}"
        case "type":
            return f"is {shown}: give a value of type {rule}"
        case "exclusiveMinimum":
            return f"is {shown}: give a number above {rule}"
        case "minimum":
            return f"is {shown}: give at least {rule}"
        case "maximum":
            return f"is {shown}: give at most {rule}"
        case "minItems" | "maxItems":
            bound = "least" if error.rule == "minItems" else "most"
            return f"has {len(error.value)} values: give at {bound} {rule}"
        case "oneOf" if {"type": "number"} in rule:
            return f"is {shown}: give a number, or a list with one for each λ"
        case "oneOf" if noun == "design":
            return 'is neither {"vertices", "triangles"} nor {"file"}: give one of them'
        case "oneOf" if "description" in error.definition:
            return f"is {shown}, and takes: {error.definition['description']}"
    return f"{error.message}: see {noun}.schema.json"
