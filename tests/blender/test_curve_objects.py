# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves objects: points, attributes and types as given, and the same object when made again."""

import bpy
import numpy as np
import pytest
from stormfield.scene.read.results import find_curves
from stormfield.scene.write.curve_objects import make_curves, remove_curves

LINES = [np.arange(9.0).reshape(3, 3), np.arange(12.0).reshape(4, 3) + 1.0]


def read(obj, name, width=1):
    attribute = obj.data.attributes[name]
    values = np.empty(len(attribute.data) * width)
    attribute.data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def test_points_attributes_and_radius_arrive(scene):
    speed = [np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0, 7.0])]
    radius = [0.1 * values for values in speed]
    flow = [line * 2.0 for line in LINES]
    obj = make_curves(
        "Lines", LINES, {"speed": speed, "flow": flow}, radius, cyclic=[True, False],
        curve_attributes={"line": np.array([7, 9]), "length": np.array([0.5, 1.5])},
    )  # fmt: skip
    assert obj.name == "Lines"
    assert obj.name in scene.collection.objects
    assert [len(curve.points) for curve in obj.data.curves] == [3, 4]
    np.testing.assert_allclose(read(obj, "position", 3), np.concatenate(LINES))
    np.testing.assert_allclose(read(obj, "speed"), [1, 2, 3, 4, 5, 6, 7])
    np.testing.assert_allclose(read(obj, "radius"), np.arange(1, 8) * 0.1, rtol=1e-6)
    np.testing.assert_allclose(read(obj, "flow", 3), 2.0 * np.concatenate(LINES))
    assert read(obj, "cyclic").tolist() == [1, 0]
    assert read(obj, "curve_type").tolist() == [1, 1]
    assert read(obj, "line").tolist() == [7, 9]
    assert obj.data.attributes["length"].domain == "CURVE"


def test_made_again_it_is_the_same_object_with_new_data(scene, ball):
    first = make_curves("Lines", LINES, {"speed": [np.ones(3), np.ones(4)]}, parent=ball)
    first.name = "renamed by the artist"
    first.modifiers.new("Nodes", "NODES")
    material = bpy.data.materials.new("own")
    first.data.materials.append(material)
    objects, data = len(bpy.data.objects), len(bpy.data.hair_curves)
    again = make_curves("Lines", LINES[:1], {"age": [np.zeros(3)]}, 0.5, parent=ball)
    assert again == first
    assert (len(bpy.data.objects), len(bpy.data.hair_curves)) == (objects, data)
    assert len(again.data.points) == 3
    assert "speed" not in again.data.attributes
    assert again.data.materials[0] == material
    assert len(again.modifiers) == 1
    assert again.parent == ball


def test_each_parent_has_its_own(scene, ball):
    other = bpy.data.objects.new("Other", None)
    scene.collection.objects.link(other)
    lines = make_curves("Lines", LINES, parent=ball)
    assert lines.name == "Ball Lines"
    assert make_curves("Lines", LINES, parent=other) != lines
    assert make_curves("Lines", LINES) not in (lines, find_curves("Lines", other))
    assert find_curves("Lines", ball) == lines


def test_no_curves_empty_the_object(scene):
    obj = make_curves("Lines", LINES, {"speed": [np.ones(3), np.ones(4)]})
    assert make_curves("Lines", []) == obj
    assert len(obj.data.points) == 0
    assert make_curves("Others", []).type == "CURVES"


def test_a_changed_type_replaces_the_attribute(scene):
    make_curves("Lines", LINES, {"flow": [np.ones(3), np.ones(4)]})
    obj = make_curves("Lines", LINES, {"flow": LINES})
    assert obj.data.attributes["flow"].data_type == "FLOAT_VECTOR"


def test_wrong_lengths_are_refused(scene):
    with pytest.raises(ValueError, match="'speed' has 5 values for 7"):
        make_curves("Lines", LINES, {"speed": [np.ones(5)]})


def test_the_evaluated_object_follows(scene):
    obj = make_curves("Lines", LINES)
    make_curves("Lines", LINES * 2)
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert len(evaluated.data.points) == 14


def test_removing_takes_the_data_along(scene):
    make_curves("Lines", LINES)
    assert remove_curves("Lines")
    assert not remove_curves("Lines")
    assert len(bpy.data.hair_curves) == 0


def test_curves_go_to_the_collection_that_is_asked_for(scene):
    collection = bpy.data.collections.new("Results")
    scene.collection.children.link(collection)
    for _ in range(2):
        made = make_curves("Lines", LINES, collection=collection)
        assert list(made.users_collection) == [collection]
