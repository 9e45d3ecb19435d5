# SPDX-License-Identifier: GPL-3.0-or-later
"""Designs as plain data: JSON in and out, and faults that say where, what and the cure."""

import copy
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stormfield.model.design import KINDS, TYPES, Design, Element, SolveSettings, check_schema
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData

EYE = {"name": "eye", "type": "singular", "kind": "vortex_ccw", "points": [[0, 0, 1], [0, 1, 0]], "lam": [0, 0.5]}
DESIGN = {"schema": "stormfield.design/1", "settings": {"samples": 20}, "elements": [EYE]}


def changed(**values):
    data = copy.deepcopy(DESIGN)
    data["elements"][0].update(values)
    return data


def fault(data) -> str:
    with pytest.raises(InputError) as caught:
        Design.from_json(data)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_reads_json():
    design = Design.from_json(DESIGN)
    assert design.settings == SolveSettings(samples=20)
    (eye,) = design.elements
    assert eye == Element("eye", "singular", ((0, 0, 1), (0, 1, 0)), (0.0, 0.5), kind="vortex_ccw")
    assert eye.acts_on("orientation") and eye.acts_on("advection")


numbers = st.floats(-10, 10, allow_nan=False)
positive = st.floats(1e-3, 10)
elements = st.builds(
    Element,
    name=st.text(min_size=1, max_size=8),
    type=st.sampled_from(TYPES),
    points=st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=4).map(tuple),
    lam=st.tuples(st.floats(0, 0.5), st.floats(0.5, 1)),
    kind=st.just("source"),
    field=st.sampled_from(["orientation", "advection", "both"]),
    strength=positive,
    radius=positive,
    hard=st.booleans(),
    angle=numbers,
    direction=st.none() | st.tuples(numbers, numbers, numbers),
    enabled=st.booleans(),
)


@given(st.lists(elements, min_size=1, max_size=4, unique_by=lambda e: e.name))
def test_json_round_trip(some):
    design = Design(tuple(some), SolveSettings(samples=7, even_speed=0.5))
    data = json.loads(json.dumps(design.to_json()))
    check_schema(data)
    if any(element.enabled for element in some):
        assert Design.from_json(data) == design


@pytest.mark.parametrize("kind", KINDS)
def test_knows_every_kind(kind):
    assert Design.from_json(changed(kind=kind)).elements[0].kind == kind


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ([], 'schema: is None: a design says "schema": "stormfield.design/1"'),
        ({**DESIGN, "schema": "stormfield.design/2"}, "schema: is 'stormfield.design/2'"),
        ({"schema": "stormfield.design/1"}, "design: elements is missing: add it"),
        ({**DESIGN, "colour": 1}, "design: colour is not known: remove it, or use one of schema, mesh"),
        (changed(kind="whirl"), 'elements[0].kind: is "whirl": use one of source, sink, saddle'),
        (changed(type="swirl"), 'elements[0].type: is "swirl": use one of singular'),
        (changed(radius=0), "elements[0].radius: is 0: give a number above 0 (element 'eye')"),
        (changed(lam=[0, 2]), "elements[0].lam[1]: is 2: give at most 1 (element 'eye')"),
        (changed(points=[[0, 0]]), "elements[0].points[0]: has 2 values: give at least 3 (element 'eye')"),
        (changed(points="x"), "elements[0].points: is \"x\": give a value of type array (element 'eye')"),
        (changed(lam=[0.5, 0.2]), "element 'eye' has λ 0.2 after 0.5: let λ grow along it"),
        (changed(lam=[0, 0.1, 0.2]), "element 'eye' has 3 λ values for 2 points: give start and end, or one per point"),
        (changed(strength=float("inf")), "element 'eye' has strength inf: give a number above 0"),
        (changed(points=[[0, 0, float("nan")]]), "element 'eye' point 0 is not finite: give three finite numbers"),
        (changed(enabled=False), "the design has no element that is turned on: add one, or enable one"),
        ({**DESIGN, "elements": []}, "the design has no element that is turned on: add one, or enable one"),
        ({**DESIGN, "elements": [EYE, EYE]}, "two elements are named 'eye': give each its own name"),
        ({**DESIGN, "settings": {"samples": 0}}, "settings.samples: is 0: give at least 1"),
        ({**DESIGN, "settings": {"even_speed": 2}}, "settings.even_speed: is 2: give at most 1"),
        ({**DESIGN, "mesh": {"vertices": []}}, "mesh: is neither"),
        (changed(**{"kind": None}), "elements[0].kind: is null: use one of"),
    ],
)
def test_faults_say_where_what_and_the_cure(data, said):
    assert fault(data).startswith(said)


def test_a_singular_element_needs_a_kind():
    data = copy.deepcopy(DESIGN)
    del data["elements"][0]["kind"]
    assert fault(data) == "elements[0]: kind is missing: add it (element 'eye')"


def test_elements_of_a_field():
    element = Design.from_json(DESIGN).elements[0]
    from dataclasses import replace

    turns, moves = replace(element, name="t", field="orientation"), replace(element, name="m", field="advection")
    design = Design((element, turns, moves, replace(element, name="off", enabled=False)))
    assert [e.name for e in design.elements_of("orientation")] == ["eye", "t"]
    assert [e.name for e in design.elements_of("advection")] == ["eye", "m"]


TRIANGLE = (np.eye(3), np.array([[0, 1, 2]]))


def test_mesh_data_is_read_only_and_typed():
    mesh = MeshData(*TRIANGLE, {"UV": np.zeros((1, 3, 2))})
    assert mesh.vertices.dtype == np.float64 and mesh.triangles.dtype == np.int32
    assert mesh.uv_layers["UV"].dtype == np.float32
    with pytest.raises(ValueError):
        mesh.vertices[0] = 1


def test_fingerprint_changes_with_vertices_and_triangles_only():
    mesh = MeshData(*TRIANGLE)
    assert mesh.fingerprint() == MeshData(*TRIANGLE, {"UV": np.zeros((1, 3, 2))}).fingerprint()
    assert mesh.fingerprint() != MeshData(np.eye(3) * 2, TRIANGLE[1]).fingerprint()
    assert mesh.fingerprint() != MeshData(np.eye(3), np.array([[1, 2, 0]])).fingerprint()


@pytest.mark.parametrize(
    ("vertices", "triangles", "layers", "said"),
    [
        (np.eye(3), np.zeros((0, 3)), {}, "the mesh is empty"),
        (np.zeros((3, 2)), [[0, 1, 2]], {}, "vertices have shape (3, 2)"),
        (np.eye(3), [[0, 1, 2, 3]], {}, "triangles have shape (1, 4)"),
        (np.eye(3), [["a", "b", "c"]], {}, "triangles are not numbers"),
        (np.eye(3), [[0, 1, 2]], {"UV": np.zeros((2, 3, 2))}, "UV layer 'UV' has 2 triangles, the mesh 1"),
    ],
)
def test_mesh_data_refuses(vertices, triangles, layers, said):
    with pytest.raises(InputError, match=said.replace("(", r"\(").replace(")", r"\)")):
        MeshData(vertices, triangles, layers)
