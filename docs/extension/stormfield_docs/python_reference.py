# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python reference: the compiled module from its docstrings, the package from its sources, without Blender."""

import ast
import importlib
import inspect
import re
from types import ModuleType
from typing import Any

from .addon import ADDON
from .commands import escaped

#: Characters of code that fit on a page.
WIDTH = 86
#: Modules of the package that programs may rely on, in the order of the page.
PUBLIC = (
    "model/design.py",
    "model/mesh_data.py",
    "model/errors.py",
    "model/words.py",
    "readers/__init__.py",
    "readers/field_data.py",
    "work.py",
    "solve.py",
    "cache/field_cache.py",
    "bake/lambda_cache.py",
    "bake/task.py",
    "bake/job.py",
    "analysis/ecg.py",
    "analysis/tracking.py",
    "analysis/mcg.py",
    "cli/__init__.py",
)

PACKAGE_HEAD = """# The package `stormfield`

The add-on is also a Python package. What is listed here runs without Blender. This page is made from the docstrings.

```python
from stormfield.model.design import Design, Element
from stormfield.readers.icosphere import icosphere
from stormfield.solve import start_solve

eye = Element("Eye", "singular", ((0.0, 0.0, 1.0),), kind="vortex_ccw", radius=0.4)
job = start_solve(icosphere(2000), Design(elements=(eye,)))
solution = job.result()  # or watch job.done and job.fraction
vectors = solution.fields["advection"].at(0.5).to_space()  # (n, 3), mesh units per second
```

"""
NATIVE_HEAD = """# The module `stormfield_native`

The compiled core. This page is made from its docstrings when the documentation is built.

Arrays are NumPy arrays; lengths are mesh units, angles radians, times seconds. Long work has two forms: `X(...)` waits
and returns the result; `start_X(...)` returns at once with a job: `done`, `fraction`, `cancel()`, `result()`.

```python
import numpy as np
import stormfield_native as native

corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 0)], dtype=float)
faces = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], dtype=np.int32)
mesh = native.TriangleMesh(corners, faces)
field = native.VectorField.from_space(mesh, corners - [0.1, 0.0, 0.0])
kinds = [str(point.kind) for point in native.fixed_points(field)]  # ['source']
```

"""


def pages() -> dict[str, str]:
    return {
        "reference/python-package.md": package_page(),
        "reference/python-native.md": native_page(importlib.import_module("stormfield_native")),
    }


# The package ----------------------------------------------------------------------------------------------------------


def package_page() -> str:
    return PACKAGE_HEAD + "".join(_module(name) for name in PUBLIC)


def _module(path: str) -> str:
    tree = ast.parse((ADDON / path).read_text(encoding="utf-8"))
    dotted = "stormfield." + path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    parts = [f"## {dotted}\n\n{docstring(ast.get_docstring(tree))}\n\n"]
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and _public(node):
            parts.append(_class(node) if isinstance(node, ast.ClassDef) else _function(node, "###"))
    return "".join(parts)


def _public(node: ast.ClassDef | ast.FunctionDef) -> bool:
    return not node.name.startswith("_") and ast.get_docstring(node) is not None


def _class(node: ast.ClassDef) -> str:
    fields = [ast.unparse(s) for s in node.body if isinstance(s, ast.AnnAssign) and not ast.unparse(s).startswith("_")]
    head = f"class {node.name}({', '.join(map(ast.unparse, node.bases))})" if node.bases else f"class {node.name}"
    code = "\n    ".join([f"{head}:" if fields else head, *fields])
    methods = [m for m in node.body if isinstance(m, ast.FunctionDef) and (_public(m) or m.name == "__init__")]
    shown = [m for m in methods if m.name != "__init__" or m.args.args[1:] or m.args.kwonlyargs]
    if not shown and not fields:
        return f"### {node.name}\n\n```python\n{code}\n```\n\n{docstring(ast.get_docstring(node))}\n\n"
    body = "".join(_function(m, "####") for m in shown)
    return f"### {node.name}\n\n```python\n{code}\n```\n\n{docstring(ast.get_docstring(node))}\n\n{body}"


def _function(node: ast.FunctionDef, level: str) -> str:
    arguments = ast.unparse(node.args)
    arguments = re.sub(r"^(self|cls)(, )?", "", arguments)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    decorators = {ast.unparse(d) for d in node.decorator_list}
    signature = (
        f"{node.name}{returns.replace(' -> ', ': ')}"
        if "property" in decorators
        else f"{node.name}({arguments}){returns}"
    )
    text = docstring(ast.get_docstring(node))
    return f"{level} {escaped(node.name)}\n\n```python\n{wrapped(signature)}\n```\n\n{text}\n\n"


# The compiled module --------------------------------------------------------------------------------------------------


def native_page(native: ModuleType) -> str:
    members = [(name, value) for name, value in sorted(vars(native).items()) if not name.startswith("_")]
    errors = [name for name, value in members if inspect.isclass(value) and issubclass(value, BaseException)]
    functions = [(name, value) for name, value in members if not inspect.isclass(value) and callable(value)]
    classes = [(name, value) for name, value in members if inspect.isclass(value) and name not in errors]
    parts = [NATIVE_HEAD, "## Functions\n\n"]
    parts += [_documented(name, value.__doc__, "###") for name, value in functions]
    parts.append("## Classes\n\n")
    parts += [_native_class(name, value) for name, value in classes]
    parts.append("## Errors\n\n")
    parts += [f"### {name}\n\n{docstring(getattr(native, name).__doc__)}\n\n" for name in errors]
    return "".join(parts)


def _native_class(name: str, cls: type) -> str:
    parts = [f"### {name}\n\n{docstring(cls.__doc__)}\n\n"]
    init = vars(cls).get("__init__")
    if init is not None and init.__doc__ and "(self" in init.__doc__:
        parts.append(_documented("__init__", init.__doc__, ""))
    attributes = [(n, v) for n, v in sorted(vars(cls).items()) if isinstance(v, property)]
    if attributes:
        parts += [f"`{n}`\n: {docstring(v.__doc__) or 'see above'}\n\n" for n, v in attributes]
    for method, value in sorted(vars(cls).items()):
        if not method.startswith("_") and not isinstance(value, property) and callable(value):
            parts.append(_documented(method, value.__doc__, ""))
    return "".join(parts)


def _documented(name: str, text: str | None, level: str) -> str:
    """A function: the signatures that pybind11 writes first, then its text."""
    signatures, rest = split_signatures(name, text or "")
    head = f"{level} {escaped(name)}\n\n" if level else ""
    return f"{head}```python\n{signatures}\n```\n\n{docstring(rest)}\n\n"


def split_signatures(name: str, text: str) -> tuple[str, str]:
    lines = text.strip().splitlines()
    signatures = [line for line in lines if re.match(rf"(\d+\. )?{re.escape(name)}\(", line)]
    rest = [line for line in lines if line not in signatures and line != "Overloaded function."]
    return "\n".join(plain(re.sub(r"^\d+\. ", "", line)) for line in signatures) or name, "\n".join(rest)


def plain(signature: str) -> str:
    """Types as a reader writes them."""
    for long, short in (
        ("stormfield_native.", ""),
        ("typing.SupportsFloat | typing.SupportsIndex", "float"),
        ("typing.SupportsInt | typing.SupportsIndex", "int"),
        ("typing.SupportsInt", "int"),
        ("typing.SupportsFloat", "float"),
        ("collections.abc.", ""),
        ("typing.", ""),
        ("numpy.typing.", ""),
    ):
        signature = signature.replace(long, short)
    signature = re.sub(r"<\w+ object at 0x\w+>", "...", signature)
    return wrapped(re.sub(r"\(self: \w+(, )?", "(", signature))


def wrapped(signature: str) -> str:
    """One argument a line where the signature is longer than a page is wide."""
    begin = signature.find("(")
    if len(signature) <= WIDTH or begin < 0:
        return signature
    depth, starts, end = 0, [begin + 1], len(signature)
    for place in range(begin, len(signature)):
        depth += (signature[place] in "([{") - (signature[place] in ")]}")
        if depth == 1 and signature[place] == ",":
            starts.append(place + 1)
        if depth == 0:
            end = place
            break
    arguments = [signature[a:b].strip().rstrip(",") for a, b in zip(starts, [*starts[1:], end], strict=True)]
    return "\n    ".join([signature[: begin + 1], *(f"{each}," for each in arguments)]) + "\n" + signature[end:]


def docstring(text: str | None) -> str:
    """Paragraphs as Markdown shows them as they are; indented lines are code."""
    blocks: list[str] = []
    for block in re.split(r"\n\s*\n", inspect.cleandoc(text or "")):
        lines = block.splitlines()
        if lines and all(line.startswith("    ") for line in lines):
            code = inspect.cleandoc("\n" + block)
            if blocks and blocks[-1].startswith("```python"):
                blocks[-1] = blocks[-1].removesuffix("\n```") + f"\n\n{code}\n```"
            else:
                blocks.append(f"```python\n{code}\n```")
        elif lines:
            blocks.append(escaped(block))
    return "\n\n".join(blocks)


def members_of(module: Any) -> list[str]:
    """Public names, for the test that each has its place on the page."""
    return [name for name in vars(module) if not name.startswith("_")]
