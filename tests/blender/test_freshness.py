# SPDX-License-Identifier: GPL-3.0-or-later
"""The sign that a field is out of date: there after every change that a solve would see, gone after Solve and undo."""

import bpy
import pytest

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def solved(storms):
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    return storms


def reason(obj):
    from stormfield.session import freshness

    bpy.context.view_layer.update()
    return freshness.why_out_of_date(obj)


def test_nothing_is_said_before_and_just_after_a_solve(storms):
    assert reason(storms) == ""
    bpy.ops.stormfield.solve()
    assert reason(storms) == ""


def test_what_no_solve_would_see_is_no_change(solved):
    solved.stormfield.lam = 0.5
    solved.location.x += 2.0  # its elements are not its children
    for element in solved.stormfield.elements:
        element.source.location.x += 2.0
    solved.stormfield.elements[0].name = "Renamed"
    solved.stormfield.look.spacing = 20
    solved.stormfield.elements.move(0, 1)
    assert reason(solved) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda obj: setattr(obj.stormfield.elements[0], "strength", 0.5), "'West' was changed"),
        (lambda obj: setattr(obj.stormfield.elements[0], "kind", "sink"), "'West' was changed"),
        (lambda obj: setattr(obj.stormfield.elements[1], "enabled", False), "'East' was removed or turned off"),
        (lambda obj: obj.stormfield.elements.remove(0), "'West' was removed or turned off"),
        (lambda obj: setattr(obj.stormfield.elements[1].source.location, "y", 0.3), "'East' was moved"),
        (lambda obj: setattr(obj.stormfield.solve, "even_speed", 0.1), "settings were changed"),
        (
            lambda obj: obj.data.vertices[7].co.__setattr__("x", 3.0) or obj.data.update(),
            "the mesh was changed, and the field on it is approximate",
        ),
        (lambda obj: obj.data.flip_normals(), "the mesh was changed"),
    ],
)
def test_each_change_is_named_and_gone_after_solve(solved, change, said):
    change(solved)
    assert reason(solved) == said
    if "mesh" not in said:
        assert bpy.ops.stormfield.solve() == {"FINISHED"}
        assert reason(solved) == ""


def test_a_change_that_is_taken_back_is_none(solved):
    element = solved.stormfield.elements[0]
    before, element.radius = element.radius, 0.9
    assert reason(solved)
    element.radius = before
    assert reason(solved) == ""


def test_a_curve_that_is_drawn_anew_is_named(storms, add_curve):
    from stormfield.scene.write.elements import add_element

    curve = add_curve([(0, 1, 0), (0, 0.7, 0.7), (0, 0, 1)], "Jet")
    add_element(storms, curve, type="streamline")
    bpy.ops.stormfield.solve()
    curve.data.splines[0].points[1].co.x = 0.2
    assert reason(storms) == "'Jet' was drawn anew"


def test_a_keyed_source_is_out_of_date_by_its_keys_and_not_by_the_frame(storms, scene):
    source = storms.stormfield.elements[0].source
    source.keyframe_insert("location", frame=1)
    source.location.y = 0.5
    source.keyframe_insert("location", frame=40)
    bpy.ops.stormfield.solve()
    scene.frame_set(30)
    assert reason(storms) == ""
    source.location.y = 0.8
    source.keyframe_insert("location", frame=40)
    assert reason(storms) == "'West' was drawn anew"


def test_undo_brings_field_and_knowledge_back_together(solved):
    bpy.ops.ed.undo_push(message="solved")
    name = solved.name
    solved.stormfield.elements[0].strength = 0.7
    bpy.ops.ed.undo_push(message="changed")
    assert reason(solved) == "'West' was changed"
    bpy.ops.ed.undo()
    assert reason(bpy.data.objects[name]) == ""


def test_what_another_version_read_is_unknown_and_not_out_of_date(solved):
    import json

    from stormfield.session import freshness

    known = json.loads(solved.stormfield.solve.solved)
    solved.stormfield.elements[0].strength = 0.5
    assert reason(solved)
    freshness.keep(solved, {**known, "names": "of an older version"})
    assert reason(solved) == ""
    freshness.keep(solved, {name: value for name, value in known.items() if name != "names"})
    assert reason(solved) == ""


def test_the_view_says_one_reason_and_counts_the_others(solved):
    from stormfield.ui import out_of_date

    assert out_of_date.sentence(solved) == ""
    solved.stormfield.elements[0].strength = 0.5
    solved.stormfield.solve.even_speed = 0.3
    bpy.context.view_layer.update()
    assert out_of_date.sentence(solved) == "Out of date: settings were changed and 1 more. Solve again"


@pytest.mark.parametrize("parented", [True, False])
def test_a_control_that_is_not_shown_has_not_moved(solved, scene, tmp_path, parented):
    from stormfield.session import freshness

    collection = bpy.data.collections.new("Controls")
    scene.collection.children.link(collection)
    for element in solved.stormfield.elements:
        source = element.source
        scene.collection.objects.unlink(source)
        collection.objects.link(source)
        if parented:
            parent = bpy.data.objects.new("Parent", None)
            collection.objects.link(parent)
            parent.location = (0.0, 0.0, 0.5)
            source.parent = parent
            source.location.z -= 0.5
    bpy.context.view_layer.update()
    assert freshness.why_out_of_date(solved) == ""
    bpy.context.view_layer.layer_collection.children["Controls"].exclude = True
    path = str(tmp_path / "hidden.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert freshness.why_out_of_date(bpy.data.objects["Ball"]) == ""
