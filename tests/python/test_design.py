# SPDX-License-Identifier: GPL-3.0-or-later
"""Designs as plain data: JSON in and out, and faults that say where, what and the cure."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stormfield.model.design import Design, Element, SolveSettings, check_schema
from stormfield.model.element_types import BRUSH_MODES, KINDS, OVER_LAMBDA, RULES, TYPES
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData

EYE = {"name": "eye", "type": "singular", "kind": "vortex_ccw", "points": [[0, 0, 1], [0, 1, 0]], "lam": [0, 0.5]}
DESIGN = {"schema": "stormfield.design/2", "settings": {"samples": 20}, "elements": [EYE]}


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
over_lambda = positive | st.tuples(positive, positive)


@st.composite
def one_of_a_type(draw):
    element = draw(any_type)
    kinds = RULES[element.type].kinds
    element = replace(element, kind=draw(st.sampled_from(kinds))) if kinds else element
    if not RULES[element.type].instant:
        return element
    numbers = {name: element.values(name)[0] for name in OVER_LAMBDA}
    return replace(element, points=element.points[:1], lam=(draw(st.floats(0.1, 0.9)),), **numbers)


any_type = st.builds(
    Element,
    name=st.text(min_size=1, max_size=8),
    type=st.sampled_from(TYPES),
    points=st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=4).map(tuple),
    lam=st.tuples(st.floats(0, 0.5), st.floats(0.5, 1)),
    kind=st.just("source"),
    field=st.sampled_from(["orientation", "advection", "both"]),
    strength=over_lambda,
    radius=over_lambda,
    rate=over_lambda,
    pull=over_lambda,
    reverse=st.booleans(),
    fade_in=st.floats(0, 1),
    mode=st.sampled_from(BRUSH_MODES),
    falloff=st.floats(0, 1),
    hard=st.booleans(),
    angle=numbers | st.tuples(numbers, numbers),
    direction=st.none() | st.tuples(numbers, numbers, numbers),
    enabled=st.booleans(),
)


@settings(deadline=None)
@given(st.lists(one_of_a_type(), min_size=1, max_size=4, unique_by=lambda e: e.name))
def test_json_round_trip(some):
    design = Design(tuple(some), SolveSettings(samples=7, even_speed=0.5))
    data = json.loads(json.dumps(design.to_json()))
    check_schema(data)
    if any(element.enabled for element in some):
        assert Design.from_json(data) == design


def test_reads_the_earlier_schema():
    assert Design.from_json({**DESIGN, "schema": "stormfield.design/1"}) == Design.from_json(DESIGN)


def test_every_type_has_rules_and_is_in_the_schema():
    assert set(RULES) == set(TYPES)
    for name, rules in RULES.items():
        kind = {"kind": rules.kinds[0]} if rules.kinds else {}
        check_schema({**DESIGN, "elements": [{"name": "x", "type": name, "points": [[0, 0, 0]], **kind}]})


def test_a_still_element_changes_at_as_many_lambdas_as_it_likes():
    data = changed(points=[[0, 0, 1]], lam=[0, 0.2, 0.9], strength=[0, 0.3, 0])
    (eye,) = Design.from_json(data).elements
    assert eye.strength == (0.0, 0.3, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_knows_every_kind(kind):
    assert Design.from_json(changed(kind=kind)).elements[0].kind == kind


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ([], 'schema: is None: a design says "schema": "stormfield.design/2"'),
        ({**DESIGN, "schema": "stormfield.design/3"}, "schema: is 'stormfield.design/3'"),
        ({"schema": "stormfield.design/2"}, "design: elements is missing: add it"),
        ({**DESIGN, "colour": 1}, "design: colour is not known: remove it, or use one of schema, mesh"),
        (changed(kind="whirl"), 'elements[0].kind: is "whirl": use one of source, sink, saddle'),
        (changed(type="swirl"), 'elements[0].type: is "swirl": use one of singular'),
        (changed(radius=0), "element 'eye' has radius 0: give a number above 0"),
        (changed(radius="wide"), 'elements[0].radius: is "wide": give a number, or a list with one for each λ'),
        (changed(strength=[0.1, 0.2, 0.3]), "element 'eye' has 3 values of strength for 2 λ: give one number, or one"),
        (changed(strength=[0.1, -0.2]), "element 'eye' has strength -0.2: a strength never falls below 0; end the"),
        (changed(strength=[0, 0]), "element 'eye' has strength 0 at every λ: give a number above 0 somewhere"),
        (changed(strength=0), "element 'eye' has strength 0: give a number above 0"),
        (changed(radius=[0.1, 0]), "element 'eye' has radius 0: give a number above 0"),
        (changed(type="orbit", kind="attracting", pull=0), "element 'eye' has pull 0: give a number above 0"),
        (changed(type="attachment", rate=-1), "element 'eye' has rate -1: give 0 or more"),
        (changed(type="orbit", kind="sink"), "element 'eye' has kind 'sink': use one of attracting, repelling"),
        (changed(type="bifurcation", kind="appear_sink"), "element 'eye' has 2 points and 2 λ: it happens at one"),
        (
            changed(type="bifurcation", kind="appear_sink", points=[[0, 0, 1]], lam=[1]),
            "element 'eye' is at λ 1, the end of the range: move it inside",
        ),
        (changed(reach=0), "elements[0].reach: is 0: give a number above 0"),
        (changed(type="brush", mode="rake"), 'elements[0].mode: is "rake": use one of replace, add, strength, smooth'),
        (changed(type="brush", falloff=2), "elements[0].falloff: is 2: give at most 1"),
        (changed(fade_in=2), "elements[0].fade_in: is 2: give at most 1"),
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
        ({**DESIGN, "settings": {"border": "dam"}}, 'settings.border: is "dam": use one of open, wall, inflow'),
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
