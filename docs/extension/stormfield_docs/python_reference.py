# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python reference: the compiled module from its stubs, the package from its sources, without Blender."""

import ast
import importlib.util
import inspect
import re
from pathlib import Path
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
    "solve/__init__.py",
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

The compiled core. This page is made from its stubs when the documentation is built.

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
        "reference/python-native.md": native_page(stub()),
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
    text = docstring(ast.get_docstring(node))
    return f"{level} {escaped(node.name)}\n\n```python\n{_signature(node)}\n```\n\n{text}\n\n"


def _signature(node: ast.FunctionDef) -> str:
    arguments = re.sub(r"^(self|cls)(, )?", "", ast.unparse(node.args))
    returns = ast.unparse(node.returns) if node.returns else ""
    if any(ast.unparse(d) == "property" for d in node.decorator_list):
        return wrapped(plain(f"{node.name}: {returns}"))
    return wrapped(plain(f"{node.name}({arguments})" + (f" -> {returns}" if returns else "")))


# The compiled module --------------------------------------------------------------------------------------------------


def stub() -> ast.Module:
    """The stub package that the build makes from the module and installs beside it."""
    found = importlib.util.find_spec("stormfield_native-stubs")
    assert found is not None and found.submodule_search_locations, "build Stormfield first: make"
    folder = next(iter(found.submodule_search_locations))  # the first on the path, as in an import
    return ast.parse((Path(folder) / "__init__.pyi").read_text(encoding="utf-8"))


def native_page(tree: ast.Module) -> str:
    public = [node for node in tree.body if not getattr(node, "name", "_").startswith("_")]
    functions = [node for node in public if isinstance(node, ast.FunctionDef)]
    classes = [node for node in public if isinstance(node, ast.ClassDef)]
    faults = [node for node in classes if any(ast.unparse(base).endswith("Error") for base in node.bases)]
    parts = [NATIVE_HEAD, "## Functions\n\n"]
    parts += [_function(node, "###") for node in sorted(functions, key=lambda node: node.name)]
    parts.append("## Classes\n\n")
    parts += [_native_class(node) for node in sorted(classes, key=lambda node: node.name) if node not in faults]
    parts.append("## Constants\n\n")
    for node in tree.body:
        name = ast.unparse(node.target) if isinstance(node, ast.AnnAssign) else "_"
        if isinstance(node, ast.AnnAssign) and not name.startswith("_"):
            parts.append(f"### {escaped(name)}\n\n```python\n{name}: {plain(ast.unparse(node.annotation))}\n```\n\n")
    parts.append("## Errors\n\n")
    parts += [f"### {node.name}\n\n{docstring(ast.get_docstring(node))}\n\n" for node in faults]
    return "".join(parts)


def _native_class(node: ast.ClassDef) -> str:
    """Its attributes as a list, its methods without headings of their own."""
    parts = [f"### {node.name}\n\n{docstring(ast.get_docstring(node))}\n\n"]
    methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
    attributes = [each for each in methods if any(ast.unparse(d) == "property" for d in each.decorator_list)]
    parts += [
        f"`{each.name}`: `{plain(ast.unparse(each.returns)) if each.returns else 'Any'}`\n"
        f": {docstring(ast.get_docstring(each)) or 'see above'}\n\n"
        for each in sorted(attributes, key=lambda each: each.name)
    ]
    shown = [each for each in methods if each.name == "__init__" or not each.name.startswith("_")]
    for each in shown:
        if each not in attributes and not any(ast.unparse(d).endswith(".setter") for d in each.decorator_list):
            parts.append(f"```python\n{_signature(each)}\n```\n\n{docstring(ast.get_docstring(each))}\n\n")
    return "".join(parts)


def plain(annotation: str) -> str:
    """Types as a reader writes them."""
    for prefix in ("numpy.typing.", "collections.abc.", "typing.", "numpy.", "stormfield_native."):
        annotation = annotation.replace(prefix, "")
    return annotation


def wrapped(signature: str) -> str:
    """One argument a line where the signature is longer than a page is wide."""
    begin = signature.find("(")
    if begin < 0:
        return signature
    depth, starts, end = 0, [begin + 1], len(signature)
    for place in range(begin, len(signature)):
        depth += (signature[place] in "([{") - (signature[place] in ")]}")
        if depth == 1 and signature[place] == ",":
            starts.append(place + 1)
        if depth == 0:
            end = place
            break
    pieces = [signature[a:b].strip().rstrip(",") for a, b in zip(starts, [*starts[1:], end], strict=True)]
    arguments = [re.sub(r"^(\w+: [^=]+)=", r"\1 = ", piece) for piece in pieces]
    line = f"{signature[: begin + 1]}{', '.join(arguments)}{signature[end:]}"
    if len(line) <= WIDTH:
        return line
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
