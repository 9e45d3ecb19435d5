# SPDX-License-Identifier: GPL-3.0-or-later
"""Every operator of the analysis can be undone and redone: objects, graphs, lists, attributes and markers with it."""

import bpy
import numpy as np
import pytest

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def solved(storms):
    if not bpy.app.build_options.usd:
        pytest.skip("this Blender has no USD")
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    return storms


def state():
    """All that an analysis leaves in the file."""
    obj = bpy.data.objects["Ball"]
    analysis = obj.stormfield.analysis
    lists = {
        which: ([item.kind for item in analysis.list(which).items], analysis.list(which).active)
        for which in ("ecg", "history", "mcg")
    }
    return {
        "objects": sorted(o.name for o in bpy.data.objects),
        "curves": sorted((c.name, len(c.points)) for c in bpy.data.hair_curves),
        "trees": sorted((t.name, len(t.nodes), len(t.links)) for t in bpy.data.node_groups),
        "attributes": sorted(a.name for a in obj.data.attributes if a.name.startswith("sf_")),
        "markers": sorted((m.name, m.frame) for m in bpy.context.scene.timeline_markers),
        "lists": lists,
        "shown": analysis.shown,
        "frame": bpy.context.scene.frame_current,
        "lam": round(obj.stormfield.lam, 6),
    }


def expect_undone(work):
    """work() changes the file; undo brings back what was, redo what came."""
    bpy.ops.ed.undo_push(message="before")
    before = state()
    assert work() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    after = state()
    assert after != before
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert state() == after


@pytest.mark.parametrize("name", ["analyze", "morse_sets", "refine_morse", "streamlines"])
def test_operators_at_one_frame(rings, name):
    expect_undone(getattr(bpy.ops.stormfield, name))


def test_forgetting_and_selecting(rings):
    bpy.ops.stormfield.analyze()
    expect_undone(lambda: bpy.ops.stormfield.select_entity(which="ecg", index=1))
    expect_undone(bpy.ops.stormfield.forget_analysis)


def test_operators_over_lambda(solved):
    expect_undone(bpy.ops.stormfield.analyze_lambda)
    expect_undone(bpy.ops.stormfield.forget_analysis)


def test_pathlines(solved):
    expect_undone(bpy.ops.stormfield.pathlines)


def test_refining_one_set(ball, put_field):
    up = np.array([0.0, 0.0, 1.0])  # turns so fast that face by face it may return everywhere
    put_field(ball, lambda places: np.cross(up, places) - 0.1 * places[:, 2:] * (up - places * places[:, 2:]))
    ball.stormfield.morse.method = "geometry"
    bpy.ops.stormfield.morse_sets()
    mcg = ball.stormfield.analysis.mcg
    mcg.active = max(range(len(mcg.items)), key=lambda i: mcg.items[i].faces)
    expect_undone(bpy.ops.stormfield.refine_set)


@pytest.fixture
def keyed_annihilation(ball, scene):
    """A bifurcation at λ = 0.42, selected; λ runs from 0 to 1 over 101 frames, the scene stands at the first."""
    from stormfield.analysis.tracking import Bifurcation, Tracking
    from stormfield.scene.write import analysis_objects

    scene.frame_start, scene.frame_end = 1, 101
    bpy.ops.stormfield.key_lambda()
    event = Bifurcation(0, 0.42, np.array([1.0, 0, 0]), "annihilation", "sink", ())
    analysis_objects.show_tracking(scene, ball, Tracking((), (event,)), "sf_advection")
    ball.stormfield.analysis.shown = "history"
    bpy.ops.stormfield.select_entity(which="history", index=0)
    scene.frame_set(1)
    return scene


def test_going_to_an_entity(keyed_annihilation):
    expect_undone(bpy.ops.stormfield.go_to_entity)


def test_updating_markers(keyed_annihilation):
    keyed_annihilation.timeline_markers.clear()
    expect_undone(bpy.ops.stormfield.update_markers)
