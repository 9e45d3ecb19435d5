# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes that are drawn as a merge become two storms that meet and one that goes on."""

import bpy
import numpy as np
import pytest


def stroke(start, end, closed=False):
    """One over the front of the ball, from one x to the other."""
    base = {"name": "", "mouse": (0, 0), "mouse_event": (0, 0), "pressure": 1, "size": 0, "time": 0, "x_tilt": 0}
    places = [(x, -((1 - x * x) ** 0.5), 0.0) for x in np.linspace(start, end, 8)]
    points = [base | {"y_tilt": 0, "is_start": not i, "location": place} for i, place in enumerate(places)]
    assert bpy.ops.curve.draw(stroke=points, use_cyclic=closed) == {"FINISHED"}


def draw(*strokes):
    assert bpy.ops.stormfield.draw_element(preset="MERGE") == {"FINISHED"}
    for ends in strokes:
        stroke(*ends)
    assert bpy.ops.stormfield.finish_drawing() == {"FINISHED"}


@pytest.mark.parametrize("west", [(-0.8, -0.03), (-0.03, -0.8)])  # whichever way each was drawn
@pytest.mark.parametrize("east", [(0.8, 0.03), (0.03, 0.8)])
def test_two_strokes_meet_and_go_on_as_one(ball, native, west, east):
    from stormfield.scene.read.design import read_design

    draw(west, east)
    _, design = read_design(bpy.context, ball)
    one, two, on = design.elements
    assert one.name == "Storm 1" and on.name == "Merged Storm"
    for element, side in ((one, -0.8), (two, 0.8)):
        assert (element.lam[0], element.lam[-1]) == pytest.approx((0.0, 0.6))
        assert element.points[0][0] == pytest.approx(side, abs=0.05)
        assert np.linalg.norm(np.array(element.points[-1]) - on.points[0]) < 1e-5
    assert (on.lam[0], on.lam[-1]) == pytest.approx((0.6, 1.0))
    assert np.linalg.norm(np.array(on.points[0]) - (0.0, -1.0, 0.0)) < 0.05


def test_a_third_stroke_is_the_way_on(ball, native):
    from stormfield.scene.read.design import read_design

    draw((-0.7, 0.0), (0.7, 0.02), (0.01, 0.3))
    _, design = read_design(bpy.context, ball)
    by_name = {element.name: element for element in design.elements}
    on = by_name["Merged Storm"]
    assert len(design.elements) == 3 and len(on.points) > 2 and on.points[-1][0] == pytest.approx(0.3, abs=0.05)
    for name in ("Storm 1", "Storm 2"):
        assert np.linalg.norm(np.array(by_name[name].points[-1]) - on.points[0]) < 1e-5


def test_what_was_drawn_solves_into_a_merge(ball, native):
    draw((-0.75, 0.0), (0.75, 0.0))
    for element in ball.stormfield.elements:
        element.radius = 0.2
    ball.stormfield.solve.samples = 10
    assert bpy.ops.stormfield.solve() == {"FINISHED"}

    def turning(lam):
        """Vortices at the front of the ball."""
        ball.stormfield.lam = lam
        bpy.context.view_layer.update()
        bpy.ops.stormfield.analyze()
        items = ball.stormfield.analysis.ecg.items
        return sum(i.kind in {"source", "sink", "center"} and i.position[1] < -0.5 for i in items)

    bpy.context.view_layer.objects.active = ball
    ball.animation_data_clear()
    assert (turning(0.1), turning(0.95)) == (2, 1)


def test_short_strokes_that_blender_has_closed_are_opened(ball):
    draw((-0.8, -0.03, True), (0.8, 0.03, True))
    assert len(ball.stormfield.elements) == 3
    assert not any(e.source.data.splines[0].use_cyclic_u for e in ball.stormfield.elements if e.source.data)


@pytest.mark.parametrize("strokes", [[(-0.5, 0.0)], [(-0.5, 0.0), (0.5, 0.0), (0.1, 0.3), (-0.2, 0.2)]])
def test_other_strokes_are_left_as_they_are(ball, strokes):
    draw(*strokes)
    (element,) = ball.stormfield.elements
    assert len(element.source.data.splines) == len(strokes)


def test_a_polyline_is_turned_round_too(ball, add_curve):
    from stormfield.scene.write import merge
    from stormfield.scene.write.elements import add_element

    curve = add_curve([(0.0, -1.0, 0.0), (-0.3, -0.95, 0.0)])
    curve.parent = ball
    second = curve.data.splines.new("POLY")
    second.points.add(1)
    for point, place in zip(second.points, [(0.3, -0.95, 0.0), (0.02, -1.0, 0.0)], strict=True):
        point.co = (*place, 1.0)
    curve[merge.MARK] = True
    element = add_element(ball, curve, type="singular", kind="vortex_cw")
    made = merge.split_into_merge(ball, element)
    assert [e.kind for e in made] == ["vortex_cw"] * 3
    ends = [made[i].source.data.splines[0].points[-1].co[:3] for i in (0, 1)]
    assert np.linalg.norm(np.array(ends[0]) - ends[1]) < 1e-6
