# SPDX-License-Identifier: GPL-3.0-or-later
"""What the core says of itself: stubs, docstrings, words, defaults and errors, against the module and the model.

mypy reads the stubs in `make lint`; tests/typing has the calls that it must refuse.
"""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import stormfield_native as core
from stormfield import native
from stormfield.bake.task import ExrSettings, FlowSettings, MorseSettings, VdbSettings
from stormfield.model import design, element_types, words
from stormfield.model.errors import InputError

LENGTH = r"(?:\.\.\.|[a-z]|\d+|height|width|last - first)(?: \+ \d)?"
SHAPE = rf"\({LENGTH},(?: {LENGTH},?)*\)"


@cache
def stubs() -> ast.Module:
    """The stub package that is installed beside the module."""
    folder = next(iter(importlib.util.find_spec("stormfield_native-stubs").submodule_search_locations))
    return ast.parse((Path(folder) / "__init__.pyi").read_text(encoding="utf-8"))


def classes() -> dict[str, ast.ClassDef]:
    return {node.name: node for node in stubs().body if isinstance(node, ast.ClassDef)}


def functions(scope: ast.Module | ast.ClassDef) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in scope.body if isinstance(node, ast.FunctionDef)}


def everything() -> dict[str, ast.FunctionDef]:
    """All functions, methods and properties by their dotted names."""
    found = functions(stubs())
    for name, scope in classes().items():
        found |= {f"{name}.{inner}": function for inner, function in functions(scope).items()}
    return found


def parameters(function: ast.FunctionDef) -> dict[str, ast.arg]:
    arguments = function.args
    return {a.arg: a for a in [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs] if a.arg != "self"}


def without_self(function: ast.FunctionDef) -> str:
    return ast.unparse(function.args).removeprefix("self, ")


def defaults(function: ast.FunctionDef) -> dict[str, object]:
    arguments = function.args
    places = [*arguments.posonlyargs, *arguments.args]
    pairs = list(zip(reversed(places), reversed(arguments.defaults), strict=False))
    pairs += [pair for pair in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True) if pair[1] is not None]
    return {a.arg: ast.literal_eval(value) for a, value in pairs}


# Stubs ----------------------------------------------------------------------------------------------------------------


def test_stubs_name_what_the_module_has():
    public = {name for name in vars(core) if not name.startswith("_")}
    values = {node.target.id for node in stubs().body if isinstance(node, ast.AnnAssign)}
    assert public == {*classes(), *functions(stubs()), *(name for name in values if not name.startswith("_"))}
    for name, scope in classes().items():
        members = {inner for inner in vars(getattr(core, name)) if not inner.startswith("_")}
        assert members == {inner for inner in functions(scope) if not inner.startswith("_")}, name


def test_stubs_leave_nothing_open():
    """Every parameter and result has a type that says something: none is Any, object, or a container of it."""
    for name, function in everything().items():
        for parameter in parameters(function).values():
            assert parameter.annotation is not None, f"{name}({parameter.arg})"
        annotations = [a.annotation for a in parameters(function).values()] + [function.returns]
        for text in map(ast.unparse, filter(None, annotations)):
            said = re.sub(r"'[^']*'", "", text)
            assert not re.search(r"\b(Any|object|Incomplete)\b|^(tuple|list|dict)$", said), f"{name}: {text}"


def test_every_array_parameter_has_a_shape_in_the_docstring():
    for name, function in everything().items():
        said = ast.get_docstring(function) or ""
        for parameter in parameters(function).values():
            if "NDArray" in ast.unparse(parameter.annotation):
                about = re.search(rf"\b{parameter.arg}\b.*", said, re.S)
                assert about and re.search(SHAPE, about.group()), f"{name}: say the shape of {parameter.arg}"


def test_every_array_result_has_a_shape_in_the_docstring():
    for name, function in everything().items():
        if name.endswith(".result"):  # of a job: what the function returns that started it
            continue
        if function.returns is not None and re.match(r"numpy|list\[numpy|tuple\[numpy", ast.unparse(function.returns)):
            assert re.search(SHAPE, ast.get_docstring(function) or ""), f"{name}: say the shape of what it returns"


def test_everything_has_a_docstring():
    for name, scope in classes().items():
        assert ast.get_docstring(scope), name
    for name, function in everything().items():
        inner = name.rsplit(".", 1)[-1]
        if not inner.startswith("__") or (inner == "__init__" and parameters(function)):
            assert ast.get_docstring(function), name


def test_functions_with_arrays_say_what_they_raise():
    for name, function in everything().items():
        if any("NDArray" in ast.unparse(a.annotation) for a in parameters(function).values()):
            assert "Raises" in (ast.get_docstring(function) or ""), f"{name}: say what it raises"


# Without waiting ------------------------------------------------------------------------------------------------------


def test_start_x_is_x_without_waiting():
    every = everything()
    started = {name: function for name, function in every.items() if name.rsplit(".", 1)[-1].startswith("start_")}
    assert len(started) > 12
    for name, function in started.items():
        plain = name.replace("start_", "")
        constructed = "".join(word.capitalize() for word in plain.split("_"))
        waits = every.get(plain) or every.get(f"{constructed}.__init__")
        assert waits is not None, f"{name} starts nothing"
        assert without_self(function) == without_self(waits), name
        result = functions(classes()[ast.unparse(function.returns)])["result"].returns
        wanted = ast.unparse(waits.returns) if plain in every else constructed
        assert ast.unparse(result) == wanted, name


# Words and defaults ---------------------------------------------------------------------------------------------------


def literal(annotation: ast.expr | None) -> tuple[str, ...]:
    """The words of the one Literal in an annotation."""
    (node,) = [
        node
        for node in ast.walk(annotation)
        if isinstance(node, ast.Subscript) and ast.unparse(node.value) == "typing.Literal"
    ]
    return ast.literal_eval(node.slice)


@pytest.mark.parametrize(
    ("place", "parameter", "known"),
    [
        ("DesignElement.__init__", "type", element_types.ElementType),
        ("DesignElement.__init__", "kind", element_types.SingularKind),
        ("DesignElement.__init__", "stability", element_types.OrbitKind),
        ("DesignElement.__init__", "event", element_types.BifurcationKind),
        ("DesignElement.__init__", "mode", element_types.BrushMode),
        ("solve_design", "border", design.Border),
        ("morse", "method", words.MorseMethod),
        ("FlowMap.image", "basis", words.FlowMapBasis),
        ("FixedPoint.kind", None, words.FixedPointKind),
        ("PeriodicOrbit.kind", None, words.OrbitKind),
        ("MorseSet.kind", None, words.MorseKind),
    ],
)
def test_the_model_has_the_words_of_the_core(place, parameter, known):
    function = everything()[place]
    annotation = function.returns if parameter is None else parameters(function)[parameter].annotation
    assert literal(annotation) == get_args(known)


def test_options_of_morse_are_those_of_the_core():
    taken = [name for name in parameters(everything()["morse"]) if name not in {"field", "progress"}]
    assert list(words.MorseOptions.__annotations__) == taken


@pytest.mark.parametrize(
    ("place", "ours"),
    [
        ("DesignElement.__init__", design.Element("", "singular", ())),
        ("solve_design", design.SolveSettings()),
        ("FlowMap.__init__", ExrSettings()),
        ("FlowMap.image", ExrSettings()),
        ("VoxelBand.__init__", VdbSettings()),
        ("AdvectedCoordinates.__init__", FlowSettings()),
        ("morse", MorseSettings()),
    ],
)
def test_defaults_of_the_model_are_those_of_the_core(place, ours):
    """The model must do without the core, and so has values of its own."""
    theirs = defaults(everything()[place])
    shared = [f.name for f in fields(ours) if f.name in theirs]
    assert shared
    for name in shared:
        value = getattr(ours, name)
        wanted = [value] if name in element_types.OVER_LAMBDA else list(value) if isinstance(value, tuple) else value
        assert theirs[name] == wanted, name


# Errors ---------------------------------------------------------------------------------------------------------------


def test_input_error_is_one_class():
    assert native.InputError is InputError and issubclass(native.MeshError, InputError)
    with pytest.raises(InputError, match="vertices has elements of type float32"):
        native.TriangleMesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32))
    with pytest.raises(InputError) as caught:
        native.TriangleMesh(np.eye(3), np.array([[0, 1, 1]], np.int32))
    assert type(caught.value) is native.MeshError
    with pytest.raises(InputError):  # from a thread of the core
        native.start_triangle_mesh(np.eye(3), np.array([[0, 1, 1]], np.int32)).result()


def test_the_core_alone_has_an_input_error_of_its_own():
    code = """if True:
        import numpy as np, stormfield_native as core
        assert core.InputError.__mro__[1] is ValueError and core.InputError.__module__ == "stormfield_native"
        for triangles, error in (([[0, 1, 1]], core.MeshError), ([[0, 1]], core.InputError)):
            try:
                core.TriangleMesh(np.eye(3), np.array(triangles, np.int32))
            except core.InputError as fault:
                assert type(fault) is error
            else:
                raise AssertionError("taken")
    """
    subprocess.run([sys.executable, "-c", code], check=True)


def test_words_are_refused_with_those_that_are_known():
    with pytest.raises(InputError, match=r"no kind of singular element 'whirl'; choose source, .* or spiral_out_cw"):
        native.DesignElement("a", "singular", np.zeros((1, 3)), kind="whirl")
    with pytest.raises(TypeError):
        native.DesignElement("a", 3, np.zeros((1, 3)))


# The package ----------------------------------------------------------------------------------------------------------


def test_the_package_is_typed():
    import stormfield

    assert (Path(inspect.getfile(stormfield)).parent / "py.typed").is_file()
