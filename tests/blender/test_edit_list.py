# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits in Blender: pairs that are cancelled, refused, undone, turned off; the list; the poll messages."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from edited_pair import AS_SOLVED, CANCELLED, EAST, NORTH, SADDLE, SOUTH, kinds, select, vectors

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


@pytest.mark.parametrize("chosen", [(SADDLE,), (SADDLE, EAST), (SADDLE, NORTH)])
def test_a_source_and_a_saddle_vanish_together(pair, chosen):
    before = vectors(pair)
    select(pair, *chosen)
    assert bpy.ops.stormfield.cancel_pair() == {"FINISHED"}
    assert kinds(pair) == CANCELLED
    (edit,) = pair.stormfield.edits
    assert (edit.type, edit.status, edit.reason, edit.lam) == ("cancel", "applied", "", 0.0)
    assert {edit.first_kind, edit.second_kind} == {"saddle", "source"} and " and " in edit.name
    assert vectors(pair) != before
    bpy.ops.stormfield.analyze()  # what the mesh carries says the same
    assert kinds(pair) == CANCELLED


def test_one_that_is_turned_off_gives_the_field_back(pair):
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    before, folder = vectors(pair), attached_folder(pair, LAMBDA)
    select(pair, SADDLE)
    bpy.ops.stormfield.cancel_pair()
    edited = vectors(pair)
    for enabled, expected in ((False, before), (True, edited)):
        pair.stormfield.edits[0].enabled = enabled
        with pytest.raises(RuntimeError, match="Solve first: edits were changed"):
            bpy.ops.stormfield.cancel_weakest()
        bpy.ops.stormfield.solve()
        assert vectors(pair) == expected
        assert pair.stormfield.edits[0].status == ("applied" if enabled else "")
        assert (attached_folder(pair, LAMBDA) == folder) is not enabled  # the cache from before, found at once
    bpy.ops.stormfield.remove_edit()
    bpy.ops.stormfield.solve()
    assert vectors(pair) == before and not pair.stormfield.edits


def test_undo_brings_the_pair_back(pair):
    select(pair, SADDLE)
    before = vectors(pair)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.cancel_pair()
    bpy.ops.ed.undo_push(message="after")
    edited = vectors(pair)
    bpy.ops.ed.undo()
    ball = bpy.data.objects["Ball"]
    assert kinds(ball) == AS_SOLVED and not ball.stormfield.edits and vectors(ball) == before
    bpy.ops.ed.redo()
    ball = bpy.data.objects["Ball"]
    assert kinds(ball) == CANCELLED and len(ball.stormfield.edits) == 1 and vectors(ball) == edited


def test_what_the_core_refuses_changes_nothing(pair):
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    bpy.ops.stormfield.cancel_weakest()
    assert kinds(pair) == CANCELLED  # the last two: no field on a sphere has none
    select(pair, NORTH, SOUTH)
    before, folder = vectors(pair), Path(attached_folder(pair, LAMBDA))
    files = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(RuntimeError) as refusal:
        bpy.ops.stormfield.cancel_pair()
    assert "source" in str(refusal.value) and "Traceback" not in str(refusal.value)
    assert vectors(pair) == before and kinds(pair) == CANCELLED and len(pair.stormfield.edits) == 1
    assert Path(attached_folder(pair, LAMBDA)) == folder
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == files


def test_weakest_and_simplify_take_the_same_pair(pair):
    assert bpy.ops.stormfield.cancel_weakest() == {"FINISHED"}
    assert kinds(pair) == CANCELLED and pair.stormfield.edits[0].type == "cancel"
    bpy.ops.stormfield.remove_edit()
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.analyze()
    assert bpy.ops.stormfield.simplify(keep=2) == {"FINISHED"}
    assert kinds(pair) == CANCELLED and pair.stormfield.edits[0].name == "Keep 2"
    with pytest.raises(RuntimeError, match="has 2 fixed points and orbits; keep fewer"):
        bpy.ops.stormfield.simplify(keep=2)


def test_two_nodes_stay_selected_when_the_list_follows(pair):
    from stormfield.operators.edit_choice import picked
    from stormfield.scene.write import selection

    select(pair, EAST)
    tree = pair.stormfield.analysis.ecg_tree
    saddle = next(node for node in tree.nodes if node.kind == "saddle")
    saddle.select, tree.nodes.active = True, saddle  # Shift and a click
    assert selection.follow_graph(pair, "ecg") and pair.stormfield.analysis.ecg.active == saddle.entity
    assert {pair.stormfield.analysis.ecg.items[i].kind for i in picked(pair)} == {"source", "saddle"}


def test_x_in_the_graph_cancels_or_says_why_not(pair):
    from types import SimpleNamespace

    from stormfield.ui.graph_editor import KEEPS, STORMFIELD_OT_keep_entity

    said: list[str] = []
    operator = SimpleNamespace(report=lambda _kind, text: said.append(text))
    context = SimpleNamespace(
        space_data=SimpleNamespace(edit_tree=pair.stormfield.analysis.ecg_tree),
        object=pair,
        scene=bpy.context.scene,
        view_layer=bpy.context.view_layer,
    )
    select(pair, NORTH, EAST)
    assert STORMFIELD_OT_keep_entity.execute(operator, context) == {"CANCELLED"}
    assert "both are repelling" in said[-1] and kinds(pair) == AS_SOLVED
    select(pair, SADDLE, EAST)
    assert STORMFIELD_OT_keep_entity.execute(operator, context) == {"FINISHED"} and len(said) == 1
    assert kinds(pair) == CANCELLED
    context.space_data.edit_tree = None
    assert STORMFIELD_OT_keep_entity.execute(operator, context) == {"CANCELLED"} and said[-1] == KEEPS


def test_a_window_solves_from_the_last_solution(pair, monkeypatch):
    from stormfield.session import solver_state
    from stormfield.solve import SolverState

    kept = SolverState()
    monkeypatch.setattr(solver_state, "of", lambda _obj: kept)
    pair.stormfield.elements[2].radius = 0.31
    bpy.ops.stormfield.solve()  # fills it
    bpy.ops.stormfield.analyze()
    select(pair, SADDLE)
    assert bpy.ops.stormfield.cancel_pair() == {"FINISHED"} and kinds(pair) == CANCELLED
    pair.stormfield.edits[0].enabled = False
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.analyze()
    assert kinds(pair) == AS_SOLVED  # an edited field is never what the next solve starts from


def test_between_two_samples_the_nearest_is_edited(pair):
    pair.stormfield.solve.samples = 20
    bpy.ops.stormfield.solve()
    bpy.context.scene.frame_set(26)
    bpy.ops.stormfield.analyze()
    names = {item.name for item in pair.stormfield.analysis.ecg.items}
    select(pair, SADDLE)
    assert bpy.ops.stormfield.cancel_pair(reach=0.0) == {"FINISHED"} and kinds(pair) == CANCELLED
    (edit,) = pair.stormfield.edits
    assert edit.lam == pytest.approx(10 / 19) and pair.stormfield.lam == pytest.approx(25 / 49)
    assert set(edit.name.split(" and ")) <= names
    bpy.context.scene.frame_set(1)  # far from there nothing is changed
    bpy.ops.stormfield.analyze()
    assert kinds(pair) == AS_SOLVED


def test_one_of_two_fields_is_edited(pair, attribute):
    pair.stormfield.elements[1].field = "advection"
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.analyze()
    assert kinds(pair) == AS_SOLVED
    before = attribute(pair, "sf_orientation").tobytes()
    select(pair, SADDLE)
    bpy.ops.stormfield.cancel_pair()
    assert pair.stormfield.edits[0].field == "advection" and pair.stormfield.edits[0].status == "applied"
    assert kinds(pair) == CANCELLED
    assert attribute(pair, "sf_orientation").tobytes() == before


def test_poll_messages_say_why(pair):
    def refusal():
        assert not bpy.ops.stormfield.cancel_pair.poll()
        with pytest.raises(RuntimeError) as caught:
            bpy.ops.stormfield.cancel_pair()
        return str(caught.value)

    assert "Select one entity in list, graph or view" in refusal()
    select(pair, NORTH, EAST)
    assert "both are repelling" in refusal()
    tree = pair.stormfield.analysis.ecg_tree
    links = [(route.source, route.target) for route in tree.routes]
    tree.routes.clear()
    select(pair, NORTH, SOUTH)
    assert "No flow leads from" in refusal()
    select(pair, NORTH)
    assert "No flow joins" in refusal()
    for source, target in links:
        route = tree.routes.add()
        route.source, route.target = source, target
    assert bpy.ops.stormfield.cancel_pair.poll()
    select(pair, NORTH, SOUTH)  # by way of the saddle
    assert bpy.ops.stormfield.cancel_pair.poll()
    select(pair, NORTH, SOUTH, SADDLE)
    assert "3 entities are selected" in refusal()
    bpy.context.scene.frame_set(30)
    assert "Analyze at this Frame again" in refusal()
    bpy.context.scene.frame_set(1)
    bpy.ops.stormfield.forget_analysis()
    assert "Analyze at this Frame first" in refusal()
    pair.stormfield.elements[0].radius *= 2
    assert "Solve first" in refusal()


def test_edits_of_entities_that_are_gone_are_refused_in_the_list(pair):
    from stormfield.model.edits import Edit, EntityAt
    from stormfield.scene.write.edits import add_edit

    before = vectors(pair)
    gone = EntityAt("attracting", (0.0, 0.0, 1.0)), EntityAt("saddle", (0.6, 0.0, 0.8))
    add_edit(pair, Edit("cancel", entities=gone), "Gone")
    bpy.ops.stormfield.solve()
    assert vectors(pair) == before
    edit = pair.stormfield.edits[0]
    assert edit.status == "refused" and "the field has no attracting orbit here" in edit.reason


def test_the_order_of_the_list_is_that_of_the_design(pair):
    from stormfield.model.edits import Edit
    from stormfield.scene.read.edits import read_edits
    from stormfield.scene.write.edits import add_edit

    for keep in (5, 3):
        add_edit(pair, Edit("simplify", keep=keep, lam=(0.5, 0.5)), f"Keep {keep}")
    assert [edit.keep for edit in read_edits(bpy.context, pair)] == [5, 3]
    bpy.ops.stormfield.move_edit(direction="UP")
    assert [edit.keep for edit in read_edits(bpy.context, pair)] == [3, 5]
    assert bpy.ops.stormfield.move_edit(direction="UP") == {"CANCELLED"}


def test_an_edit_that_was_changed_waits(pair):
    select(pair, SADDLE)
    bpy.ops.stormfield.cancel_pair()
    edit = pair.stormfield.edits[0]
    for name, value in (("reach", 0.2), ("enabled", False), ("enabled", True), ("lam", 0.5)):
        edit.status = "applied"
        setattr(edit, name, value)
        assert edit.status == "", name
    edit.status = "applied"
    edit.name = "Another"
    assert edit.status == "applied"
    bpy.ops.stormfield.solve()
    assert edit.status in {"applied", "refused"}


def test_a_field_without_a_cache_says_what_to_do(rings):
    bpy.ops.stormfield.analyze()
    with pytest.raises(RuntimeError, match="not solved here: Solve first"):
        bpy.ops.stormfield.cancel_weakest()


# Fields that were given -----------------------------------------------------------------------------------------------


@pytest.fixture
def given(pair):
    """The pair's field as an attribute of a ball without elements."""
    values = np.frombuffer(vectors(pair), np.float32)
    attribute = pair.data.attributes.new("wind", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", values)
    bpy.ops.stormfield.forget_analysis()
    pair.stormfield.elements.clear()
    assert bpy.ops.stormfield.field_from_attribute(attribute="wind") == {"FINISHED"}
    assert bpy.ops.stormfield.analyze() == {"FINISHED"} and kinds(pair) == AS_SOLVED
    return pair


def test_a_given_field_is_edited_and_given_back(given):
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    before, folder = vectors(given), attached_folder(given, LAMBDA)
    select(given, SADDLE, EAST)
    assert bpy.ops.stormfield.cancel_pair() == {"FINISHED"} and kinds(given) == CANCELLED
    edited = vectors(given)
    assert edited != before and given.stormfield.edits[0].status == "applied"
    assert bpy.ops.stormfield.cancel_weakest.poll()
    given.stormfield.edits[0].enabled = False
    with pytest.raises(RuntimeError, match="Apply Edits first: edits were changed"):
        bpy.ops.stormfield.cancel_weakest()
    assert bpy.ops.stormfield.apply_edits() == {"FINISHED"}
    assert vectors(given) == before and attached_folder(given, LAMBDA) == folder
    given.stormfield.edits[0].enabled = True
    assert bpy.ops.stormfield.apply_edits() == {"FINISHED"} and vectors(given) == edited
    # Two of the list act on the field as it was given, not on what the first has made.
    assert bpy.ops.stormfield.transform_field(angle=90, lam_start=0, lam_end=0) == {"FINISHED"}
    assert [edit.status for edit in given.stormfield.edits] == ["applied", "applied"]
    bpy.ops.stormfield.remove_edit()
    bpy.ops.stormfield.apply_edits()
    assert vectors(given) == edited


def test_a_given_field_whose_first_cache_is_gone_says_so(given):
    import shutil

    from stormfield.scene.read.attached import LAMBDA, attached_folder

    folder = Path(attached_folder(given, LAMBDA))
    select(given, SADDLE, EAST)
    bpy.ops.stormfield.cancel_pair()
    edited = vectors(given)
    shutil.rmtree(folder)
    bpy.ops.stormfield.remove_edit()
    with pytest.raises(RuntimeError, match="is gone: import it, or read its attribute, again"):
        bpy.ops.stormfield.apply_edits()
    assert vectors(given) == edited


def test_what_the_core_refuses_of_a_given_field_changes_nothing(given):
    bpy.ops.stormfield.cancel_weakest()
    select(given, NORTH, SOUTH)
    before = vectors(given)
    with pytest.raises(RuntimeError) as refusal:
        bpy.ops.stormfield.cancel_pair()
    assert "Traceback" not in str(refusal.value)
    assert vectors(given) == before and len(given.stormfield.edits) == 1


def test_apply_edits_is_for_given_fields(pair):
    with pytest.raises(RuntimeError, match="Solve applies the edits"):
        bpy.ops.stormfield.apply_edits()


def test_a_cache_that_cannot_be_written_changes_nothing(pair, monkeypatch):
    from stormfield.cache.field_cache import FieldCacheWriter

    def refuse(*_):
        raise PermissionError(13, "Permission denied", "caches")

    before = vectors(pair)
    select(pair, SADDLE)
    monkeypatch.setattr(FieldCacheWriter, "write_sample", refuse)
    monkeypatch.setattr(FieldCacheWriter, "write_all", refuse)
    with pytest.raises(RuntimeError, match="Permission denied"):
        bpy.ops.stormfield.cancel_pair()
    assert vectors(pair) == before and not pair.stormfield.edits and kinds(pair) == AS_SOLVED


EDITS = ("cancel_pair", "cancel_weakest", "simplify", "move_point", "smooth_region", "transform_field", "apply_edits")


@pytest.mark.parametrize("name", EDITS)
def test_objects_without_a_field_are_refused_in_words(name):
    bpy.ops.mesh.primitive_cube_add()
    for _ in range(2):
        with pytest.raises(RuntimeError, match="Select a mesh with a Stormfield field"):
            getattr(bpy.ops.stormfield, name)()
        bpy.ops.object.camera_add()


@pytest.mark.parametrize("name", EDITS)
def test_a_field_that_is_not_there_yet_is_refused_in_words(ball, name):
    with pytest.raises(RuntimeError) as refusal:
        getattr(bpy.ops.stormfield, name)()
    assert "first" in str(refusal.value).lower() or "Solve applies" in str(refusal.value)


def test_undo_gives_a_given_field_back(given):
    select(given, SADDLE, EAST)
    before = vectors(given)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.cancel_pair()
    bpy.ops.ed.undo_push(message="after")
    edited = vectors(given)
    bpy.ops.ed.undo()
    ball = bpy.data.objects["Ball"]
    assert vectors(ball) == before and kinds(ball) == AS_SOLVED and not ball.stormfield.edits
    select(ball, SADDLE, EAST)
    assert bpy.ops.stormfield.cancel_pair() == {"FINISHED"} and vectors(ball) == edited
