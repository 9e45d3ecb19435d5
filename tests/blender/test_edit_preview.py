# SPDX-License-Identifier: GPL-3.0-or-later
"""What edits would do, before they are made: partners of the selected entity, and what Simplify would leave."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from edited_pair import AS_SOLVED, CANCELLED, EAST, NORTH, SADDLE, SOUTH, kinds, select

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


def place_of(obj, wanted):
    ecg = obj.stormfield.analysis.ecg
    alike = [i for i, item in enumerate(ecg.items) if item.kind == wanted[0]]
    return min(alike, key=lambda i: np.linalg.norm(np.array(ecg.items[i].position) - wanted[1]))


def test_partners_are_those_that_can_be_cancelled(pair):
    from stormfield.session import edit_preview

    select(pair, SADDLE)
    found = edit_preview.partners(pair)
    assert set(found) == set(range(4)) - {place_of(pair, SADDLE)}
    for legal in (NORTH, EAST):
        partner = found[place_of(pair, legal)]
        assert partner.reason == "" and partner.left == "nothing" and len(partner.faces)
    # What is said before is what happens.
    select(pair, SADDLE, EAST)
    assert bpy.ops.stormfield.cancel_pair() == {"FINISHED"} and kinds(pair) == CANCELLED
    select(pair, NORTH)  # the last two
    (last,) = edit_preview.partners(pair).values()
    assert last.reason and "Traceback" not in last.reason and not len(last.faces)


def test_no_partners_are_shown_of_what_cannot_be_edited(pair):
    from stormfield.session import edit_preview

    select(pair, SADDLE)
    assert edit_preview.partners(pair)
    pair.stormfield.analysis.show_partners = False
    assert edit_preview.partners(pair) == {}
    pair.stormfield.analysis.show_partners = True
    pair.stormfield.lam = 0.5  # another λ than the graph's
    assert edit_preview.partners(pair) == {}
    pair.stormfield.lam = 0.0
    pair.stormfield.analysis.ecg.active = -1
    assert edit_preview.partners(pair) == {}
    bpy.ops.stormfield.forget_analysis()
    assert edit_preview.partners(pair) == {} and edit_preview.simpler(pair) is None


def test_simplify_is_previewed_as_it_will_be(pair):
    from stormfield.session import edit_preview

    analysis = pair.stormfield.analysis
    assert edit_preview.simpler(pair) is None  # not asked for
    analysis.preview_simplify, analysis.keep = True, 2
    simpler = edit_preview.simpler(pair)
    gone = {analysis.ecg.items[i].kind for i in simpler.vanish}
    assert simpler.count == 2 and gone == {"source", "saddle"} and simpler.new == ()
    analysis.keep = 4  # nothing to do
    assert edit_preview.simpler(pair) is None
    analysis.keep = 2
    bpy.ops.stormfield.simplify(keep=2)
    assert kinds(pair) == CANCELLED != AS_SOLVED


def test_two_are_selected_in_the_view_with_shift(pair):
    from stormfield.operators.edit_choice import picked

    select(pair, SADDLE)
    saddle, east = place_of(pair, SADDLE), place_of(pair, EAST)
    bpy.ops.stormfield.select_entity(which="ecg", index=east, extend=True)
    assert picked(pair) == tuple(sorted((saddle, east))) and pair.stormfield.analysis.ecg.active == east
    bpy.ops.stormfield.select_entity(which="ecg", index=place_of(pair, SOUTH))
    assert picked(pair) == (place_of(pair, SOUTH),)


def test_a_marker_that_is_pulled_moves_its_point(pair, monkeypatch):
    from stormfield.ui import pick

    moved = []
    operators = SimpleNamespace(move_point=lambda *given, **settings: moved.append((given, settings)))
    monkeypatch.setattr(pick, "bpy", SimpleNamespace(ops=SimpleNamespace(stormfield=operators)))
    gizmo = SimpleNamespace(pressed=(10, 10))
    context = SimpleNamespace(preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)))

    def modal(kind, x):
        event = SimpleNamespace(type=kind, mouse_region_x=x, mouse_region_y=10)
        return pick.STORMFIELD_GT_entities.modal(gizmo, context, event, set())

    assert modal("MOUSEMOVE", 12) == {"RUNNING_MODAL"} and not moved  # a hand that shakes
    assert modal("MOUSEMOVE", 30) == {"FINISHED"} and moved == [(("INVOKE_DEFAULT",), {"held": True})]
    assert modal("LEFTMOUSE", 10) == {"FINISHED"}
