# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of the folders, as tests/layering/test_layering.py states and checks it."""

import ast
from pathlib import Path

TEST = Path(__file__).parents[3] / "tests" / "layering" / "test_layering.py"
#: Tables of that file by the name the pages use.
TABLES = {"native": "NATIVE", "addon": "PARTS"}


def allowed(part: str) -> dict[str, list[str]]:
    """Each folder and what it may use besides itself. Raises KeyError when the test has no such table."""
    tree = ast.parse(TEST.read_text(encoding="utf-8"))
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and getattr(statement.targets[0], "id", "") == TABLES[part]:
            return {_text(key): [_text(each) for each in _items(value)] for key, value in _pairs(statement.value)}
    raise KeyError(f"{TEST} has no table {TABLES[part]}")


def table(part: str) -> list[tuple[str, str]]:
    return [(folder, ", ".join(others) or "nothing") for folder, others in allowed(part).items()]


def _pairs(node: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    if not isinstance(node, ast.Dict):
        raise KeyError("the table is not written as a dictionary")
    return [(key, value) for key, value in zip(node.keys, node.values, strict=True) if key is not None]


def _items(node: ast.expr) -> list[ast.expr]:
    """The entries of a list, tuple or set; [*[...], ...] counts as one list."""
    found: list[ast.expr] = []
    for each in getattr(node, "elts", []):
        found += _items(each.value) if isinstance(each, ast.Starred) else [each]
    return found


def _text(node: ast.expr) -> str:
    return str(ast.literal_eval(node))
