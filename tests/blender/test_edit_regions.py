# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of regions and places in Blender: Move Point, Smooth Region, Transform; and bad input."""

import bmesh
import bpy
import numpy as np
import pytest
from edited_pair import AS_SOLVED, EAST, SADDLE, kinds, select, vectors

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


def places(obj):
    values = np.empty(len(obj.data.vertices) * 3, np.float32)
    obj.data.vertices.foreach_get("co", values)
    return values.reshape(-1, 3)


def array(obj):
    return np.frombuffer(vectors(obj), np.float32).reshape(-1, 3)


def point(obj, wanted):
    kind, place = wanted
    alike = [np.array(item.position) for item in obj.stormfield.analysis.ecg.items if item.kind == kind]
    return min(alike, key=lambda its: np.linalg.norm(its - place))


def unit(*place):
    return tuple(np.array(place) / np.linalg.norm(place))


def choose_faces(obj, inside):
    """As an artist selects them in Edit Mode, which stays on."""
    bpy.ops.object.mode_set(mode="EDIT")
    shape = bmesh.from_edit_mesh(obj.data)
    for face in shape.faces:
        face.select_set(bool(inside(np.array(face.calc_center_median()))))
    bmesh.update_edit_mesh(obj.data)


def near_saddle(place):
    return np.linalg.norm(place - unit(0.6, 0, 0.8)) < 0.35


# Move -----------------------------------------------------------------------------------------------------------------


def test_a_point_is_moved_by_numbers(pair):
    goal = unit(0.9, 0.3, 0.1)
    select(pair, EAST)
    before = array(pair)
    assert bpy.ops.stormfield.move_point(to=goal) == {"FINISHED"}
    assert kinds(pair) == AS_SOLVED
    edge = np.linalg.norm(places(pair)[pair.data.edges[0].vertices[0]] - places(pair)[pair.data.edges[0].vertices[1]])
    assert np.linalg.norm(point(pair, EAST) - goal) < 0.2 * edge
    (edit,) = pair.stormfield.edits
    assert (edit.type, edit.status, edit.first_kind) == ("move", "applied", "source") and edit.name.startswith("Move ")
    away = (places(pair) @ np.array(goal)) < -0.2
    assert (array(pair)[away] == before[away]).all()


def test_a_point_that_cannot_go_there_stays(pair):
    select(pair, EAST)
    before = vectors(pair)
    with pytest.raises(RuntimeError) as refusal:
        bpy.ops.stormfield.move_point(to=unit(0, 0.01, -1))  # where the sink is
    assert "Traceback" not in str(refusal.value)
    assert vectors(pair) == before and not pair.stormfield.edits and kinds(pair) == AS_SOLVED


def test_what_cannot_be_moved_says_so(pair):
    with pytest.raises(RuntimeError, match="Give the place"):
        select(pair, EAST)
        bpy.ops.stormfield.move_point()
    pair.stormfield.analysis.ecg.active = -1
    with pytest.raises(RuntimeError, match="Select a fixed point"):
        bpy.ops.stormfield.move_point(to=(1, 0, 0))
    select(pair, EAST)
    pair.stormfield.analysis.ecg.items[pair.stormfield.analysis.ecg.active].kind = "attracting"
    with pytest.raises(RuntimeError, match="those can be moved"):
        bpy.ops.stormfield.move_point(to=(1, 0, 0))


def test_places_are_tried_while_a_point_is_dragged(pair):
    """What the pointer does, without it: the newest place wins."""
    import time

    from stormfield.edits.trial import MoveTrial
    from stormfield.model.edits import EntityAt
    from stormfield.scene.read.mesh import read_mesh
    from stormfield.scene.read.sample import Sample
    from stormfield.work import run

    sample = Sample(pair, read_mesh(pair), 0.0, "sf_advection")
    trial = MoveTrial(run(sample.field()), EntityAt("source", tuple(point(pair, EAST))))

    def tried(place):
        trial.aim(np.array(place))
        for _ in range(1000):
            if trial.poll() and np.allclose(trial.result.place, place):
                return trial.result
            time.sleep(0.01)
        raise AssertionError("nothing was tried")

    trial.aim(np.array(unit(0.5, 0.5, 0.5)))
    good = tried(unit(0.9, 0.3, 0.1))
    assert good.allowed and len(good.faces) and good.reason == ""
    bad = tried(unit(0, 0.01, -1))
    assert not bad.allowed and bad.reason
    trial.close()


def test_dragging_replaces_no_method_of_long_work_by_chance():
    """What it adds between a press and the release has names of its own: the job that follows uses the others."""
    from stormfield.operators.edit_move import STORMFIELD_OT_move_point
    from stormfield.operators.job_operator import JobOperator

    own = {name for name, value in vars(STORMFIELD_OT_move_point).items() if callable(value)}
    assert own & set(dir(JobOperator)) <= {"why_not", "start", "invoke", "modal", "cancel", "__module__", "__doc__"}


def test_a_drag_shows_a_ghost_and_gives_back_what_was(pair):
    from stormfield.session import edit_ghost
    from stormfield.session.edit_ghost import Ghost

    assert edit_ghost.of(pair) is None
    edit_ghost.show(pair, Ghost(np.arange(3), np.zeros(3), "source", False, "in the way"))
    assert edit_ghost.of(pair).text == "in the way"
    edit_ghost.show(pair, None)
    assert edit_ghost.of(pair) is None


# Smooth ---------------------------------------------------------------------------------------------------------------


def test_selected_faces_are_smoothed_and_kept_as_an_attribute(pair):
    before = array(pair)
    choose_faces(pair, near_saddle)
    assert bpy.ops.stormfield.smooth_region(region="FACES") == {"FINISHED"}
    assert pair.mode == "OBJECT"
    (edit,) = pair.stormfield.edits
    assert (edit.type, edit.status, edit.region, edit.faces) == ("smooth", "applied", "FACES", "Flow Region")
    attribute = pair.data.attributes["Flow Region"]
    assert (attribute.domain, attribute.data_type) == ("FACE", "BOOLEAN")
    changed = (array(pair) != before).any(axis=1)
    inside = np.array([near_saddle(place) for place in places(pair)])
    assert changed.any() and not (changed & ~inside).any()
    # The region can be changed like any attribute: the list waits for a solve then.
    attribute.data.foreach_set("value", np.zeros(len(pair.data.polygons), bool))
    pair.data.update_tag()
    with pytest.raises(RuntimeError, match="Solve first: edits were changed"):
        bpy.ops.stormfield.cancel_weakest()
    with pytest.raises(RuntimeError, match="'Flow Region' holds no face"):
        bpy.ops.stormfield.solve()
    edit.enabled = False
    bpy.ops.stormfield.solve()
    assert (array(pair) == before).all()


def add_loop(obj, radius):
    """A closed curve around the saddle, selected beside the mesh."""
    middle = np.array(unit(0.6, 0, 0.8))
    across = np.array([0.8, 0, -0.6])
    data = bpy.data.curves.new("Loop", "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(31)
    spline.use_cyclic_u = True
    for number, at in enumerate(spline.points):
        angle = 2 * np.pi * number / 32
        away = np.cos(angle) * across + np.sin(angle) * np.array([0, 1.0, 0])
        at.co = (*(np.cos(radius) * middle + np.sin(radius) * away), 1)
    curve = bpy.data.objects.new("Loop", data)
    bpy.context.scene.collection.objects.link(curve)
    bpy.context.view_layer.update()
    curve.select_set(True)
    obj.select_set(True)
    return curve


def test_a_drawn_loop_is_smoothed(pair):
    before = array(pair)
    curve = add_loop(pair, 0.35)
    assert bpy.ops.stormfield.smooth_region(region="LOOP") == {"FINISHED"}
    (edit,) = pair.stormfield.edits
    assert (edit.region, edit.loop, edit.status) == ("LOOP", curve, "applied")
    changed = (array(pair) != before).any(axis=1)
    assert changed.any() and not (changed & (np.linalg.norm(places(pair) - unit(0.6, 0, 0.8), axis=1) > 0.55)).any()
    curve.location.x += 0.2
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="Solve first: edits were changed"):
        bpy.ops.stormfield.cancel_weakest()


def test_a_vertex_group_is_smoothed(pair):
    before = array(pair)
    group = pair.vertex_groups.new(name="Patch")
    chosen = [i for i, place in enumerate(places(pair)) if near_saddle(place)]
    group.add(chosen, 1.0, "REPLACE")
    assert bpy.ops.stormfield.smooth_region(region="GROUP") == {"FINISHED"}
    assert (pair.stormfield.edits[0].region, pair.stormfield.edits[0].faces) == ("GROUP", "Patch")
    changed = np.flatnonzero((array(pair) != before).any(axis=1))
    assert len(changed) and set(changed) <= set(chosen)


def test_a_disc_around_an_entity_is_smoothed(pair):
    before = array(pair)
    select(pair, SADDLE)
    assert bpy.ops.stormfield.smooth_region(region="DISC", radius=0.4, reach=0.0) == {"FINISHED"}
    changed = (array(pair) != before).any(axis=1)
    assert changed.any() and not (changed & (np.linalg.norm(places(pair) - point(pair, SADDLE), axis=1) > 0.6)).any()


@pytest.mark.parametrize(
    ("region", "fault"),
    [
        ("FACES", "Select faces of 'Ball' in Edit Mode first"),
        ("LOOP", "Select a closed curve on 'Ball' as well"),
        ("GROUP", "'Ball' has no vertex group"),
        ("DISC", "Select an entity in list or view first"),
    ],
)
def test_regions_that_were_not_chosen(pair, region, fault):
    pair.data.polygons.foreach_set("select", np.zeros(len(pair.data.polygons), bool))
    pair.stormfield.analysis.ecg.active = -1
    before = vectors(pair)
    with pytest.raises(RuntimeError, match=fault):
        bpy.ops.stormfield.smooth_region(region=region)
    assert vectors(pair) == before and not pair.stormfield.edits and "Flow Region" not in pair.data.attributes


def test_regions_that_cannot_be_smoothed_change_nothing(pair):
    before = vectors(pair)
    pair.data.polygons.foreach_set("select", np.ones(len(pair.data.polygons), bool))
    with pytest.raises(RuntimeError, match="covers a whole surface"):
        bpy.ops.stormfield.smooth_region(region="FACES")
    one = np.zeros(len(pair.data.polygons), bool)
    one[3] = True
    pair.data.polygons.foreach_set("select", one)
    with pytest.raises(RuntimeError, match="has no vertex inside"):
        bpy.ops.stormfield.smooth_region(region="FACES")
    assert vectors(pair) == before and not pair.stormfield.edits


def test_regions_that_are_gone_are_named(pair):
    from stormfield.model.edits import Edit
    from stormfield.scene.write.edits import add_edit

    for members, fault in (
        ({"region": "FACES", "faces": "Gone"}, "has no boolean attribute 'Gone'"),
        ({"region": "GROUP", "faces": "Gone"}, "has no vertex group 'Gone'"),
        ({"region": "LOOP"}, "has no curve"),
        ({"region": "ALL"}, "needs something around it"),
        ({"region": "DISC", "radius": 0.0}, "has no radius"),
    ):
        add_edit(pair, Edit("smooth"), "Broken", **members)
        with pytest.raises(RuntimeError, match=fault):
            bpy.ops.stormfield.solve()
        bpy.ops.stormfield.remove_edit()


# Transform ------------------------------------------------------------------------------------------------------------


def turned(values, normals, degrees):
    """Turned about the normals."""
    a = np.radians(degrees)
    return np.cos(a) * values + np.sin(a) * np.cross(normals, values)


def test_the_field_turns_over_lambda(pair):
    before = array(pair)
    assert bpy.ops.stormfield.transform_field(angle=90) == {"FINISHED"}
    (edit,) = pair.stormfield.edits
    assert (edit.type, edit.status, edit.region, edit.angle, edit.lam, edit.lam_end) == (
        *("transform", "applied", "ALL", 90, 0, 1),
    )
    assert edit.name == "Turn 90°"
    assert (array(pair) == before).all()  # at λ 0 it only begins
    pair.stormfield.analysis.ecg.active = -1
    from stormfield.cache.field_cache import open_cache
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    last = open_cache(attached_folder(pair, LAMBDA)).sample(1)["sf_advection"]
    still = array(pair)
    np.testing.assert_allclose(last, turned(still, places(pair), 90), atol=2e-2 * np.abs(still).max())
    np.testing.assert_allclose(np.linalg.norm(last, axis=1), np.linalg.norm(still, axis=1), rtol=1e-5)


def test_keys_of_a_transform_are_read_over_lambda(pair):
    from stormfield.scene.read.edits import read_edits

    bpy.ops.stormfield.transform_field(angle=90)
    edit = pair.stormfield.edits[0]
    for frame, angle in ((1, 0.0), (25, 180.0), (50, 0.0)):
        edit.angle = angle
        edit.keyframe_insert("angle", frame=frame)
    pair.stormfield.solve.samples = 3
    for frame, lam in ((1, 0.0), (50, 1.0)):
        pair.stormfield.lam = lam
        pair.keyframe_insert("stormfield.lam", frame=frame)
    course = dict(read_edits(bpy.context, pair)[0].transform.angle)
    assert course[0.0] == 0.0 and max(course.values()) == pytest.approx(180.0)
    bpy.ops.stormfield.solve()
    assert edit.status == "applied"
    bpy.context.scene.frame_set(10)  # which changes the value, but not what is said
    assert bpy.ops.stormfield.solve.poll()
    from stormfield.session import freshness

    assert freshness.why_out_of_date(pair) == ""
    edit.keyframe_insert("angle", frame=10)
    for curve in curves(pair):
        if curve.data_path.endswith("angle"):
            curve.keyframe_points[1].co.y = 33.0
    pair.update_tag()
    bpy.context.view_layer.update()
    assert freshness.why_out_of_date(pair) == "edits were changed"


def curves(obj):
    from stormfield import compat

    return list(compat.fcurves(obj))


def test_transforms_that_say_nothing_are_refused(pair):
    with pytest.raises(RuntimeError, match="changes nothing"):
        bpy.ops.stormfield.transform_field(angle=0)
    assert not pair.stormfield.edits


def test_a_stretch_along_a_drawn_axis(pair):
    bpy.ops.stormfield.transform_field(angle=0, stretch=3, lam_start=0, lam_end=0)
    edit = pair.stormfield.edits[0]
    edit.axis = "CURVE"
    with pytest.raises(RuntimeError, match="has no curve; choose one"):
        bpy.ops.stormfield.solve()
    data = bpy.data.curves.new("Axis", "CURVE")
    data.dimensions = "3D"
    line = data.splines.new("POLY")
    line.points.add(1)
    line.points[1].co = (0, 0, 2, 1)
    edit.axis_curve = bpy.data.objects.new("Axis", data)
    bpy.context.scene.collection.objects.link(edit.axis_curve)
    edit.enabled = False
    bpy.ops.stormfield.solve()
    before = array(pair)
    edit.enabled = True
    bpy.ops.stormfield.solve()
    assert edit.status == "applied"
    round_ = np.abs(places(pair)[:, 2]) < 0.1
    np.testing.assert_allclose(array(pair)[round_, 2], 3 * before[round_, 2], rtol=0.1, atol=1e-3)


def test_each_is_one_undo_step(pair):
    before = vectors(pair)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.transform_field(angle=45, lam_start=0, lam_end=0)
    bpy.ops.ed.undo_push(message="after")
    assert vectors(pair) != before
    bpy.ops.ed.undo()
    ball = bpy.data.objects["Ball"]
    assert vectors(ball) == before and not ball.stormfield.edits
