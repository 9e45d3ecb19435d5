# SPDX-License-Identifier: GPL-3.0-or-later
"""State of the session belongs to its object: renaming, undo and redo keep it, a duplicate has none."""

import bpy
import pytest

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def divided(rings):
    """The ball with its Morse sets."""
    rings.stormfield.morse.method = "geometry"
    assert bpy.ops.stormfield.morse_sets() == {"FINISHED"}
    return rings


def test_renaming_keeps_what_refinement_goes_on_from(divided):
    from stormfield.session import morse_state

    state = morse_state.of(divided)
    assert state is not None
    divided.name = "Planet"
    other = bpy.data.objects.new("Ball", divided.data)
    assert morse_state.of(divided) is state and morse_state.of(other) is None
    assert morse_state.simplify(divided)


def test_renaming_keeps_the_preview(divided):
    from stormfield.session import morse_preview

    divided.stormfield.morse.live = True
    preview = morse_preview.of(divided)
    assert preview is not None
    divided.name = "Planet"
    assert morse_preview.of(divided) is preview
    divided.stormfield.morse.live = False
    divided.stormfield.morse.live = True
    assert morse_preview.of(divided).version > preview.version


def test_undo_and_redo_keep_the_state_and_a_duplicate_has_none(divided):
    from stormfield.session import morse_state, objects

    uid, state = divided.session_uid, morse_state.of(divided)
    bpy.ops.ed.undo_push(message="before")
    divided.name = "Planet"
    bpy.ops.ed.undo_push(message="renamed")
    bpy.ops.ed.undo()
    assert objects.find(uid).name == "Ball" and morse_state.of(objects.find(uid)) is state
    bpy.ops.ed.redo()
    planet = objects.find(uid)
    assert planet.name == "Planet" and morse_state.of(planet) is state
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    planet.select_set(True)
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    assert twin != planet and twin.session_uid != uid and morse_state.of(twin) is None
    assert morse_state.of(planet) is state


def test_an_object_that_is_gone_is_not_found(ball):
    from stormfield.session import objects

    uid = ball.session_uid
    assert objects.find(uid) == ball
    bpy.data.objects.remove(ball)
    assert objects.find(uid) is None


def test_the_solver_state_belongs_to_one_object(ball, scene, monkeypatch):
    from types import SimpleNamespace

    from stormfield.session import solver_state

    assert solver_state.of(ball) is None  # in background mode
    monkeypatch.setattr(solver_state, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    state = solver_state.of(ball)
    ball.name = "Planet"
    assert solver_state.of(ball) is state
    other = bpy.data.objects.new("Ball", ball.data)
    assert solver_state.of(other) is not state and solver_state.of(ball) is not state
    solver_state.forget()


def test_renaming_keeps_the_collection_of_the_analysis(rings):
    bpy.ops.stormfield.analyze()
    collection = rings.stormfield.analysis.collection
    rings.name = "Planet"
    bpy.ops.stormfield.analyze()
    assert rings.stormfield.analysis.collection == collection and len(bpy.data.collections) == 1
