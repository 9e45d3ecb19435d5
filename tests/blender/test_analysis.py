# SPDX-License-Identifier: GPL-3.0-or-later
"""What an analysis leaves in Blender: collection, lists, node trees, markers, one selection. Graphs made by hand."""

import bpy
import numpy as np
import pytest

pytest.importorskip("igraph", reason="igraph is not installed")


@pytest.fixture
def entities():
    from stormfield.analysis.entities import Entity, EntityGraph, Link

    circle = np.linspace(0, 2 * np.pi, 25)
    orbit = 0.7 * np.stack([np.cos(circle), np.sin(circle), np.full(25, 1.0)], axis=1)
    orbit[-1] = orbit[0]
    places = np.eye(3)

    def make(count=4, lam=0.25):
        all_of_them = (
            Entity(0, "R1", "source", "repelling", places[0], strength=2.0),
            Entity(1, "S2", "saddle", "saddle", places[1], strength=1.0),
            Entity(2, "A3", "sink", "attracting", places[2], strength=0.5),
            Entity(3, "A4", "attracting", "attracting", orbit[0], curve=orbit, strength=0.1, info={"period": 2.5}),
        )
        lines = tuple(np.linspace(places[a], places[b], 5) for a, b in ((0, 1), (1, 2)))
        links = (Link(0, 1, (lines[0], lines[0])), Link(1, 2, (lines[1],)), Link(0, 3))
        links = tuple(link for link in links if max(link.source, link.target) < count)
        return EntityGraph("Entity connection graph", all_of_them[:count], links, lam)

    return make


@pytest.fixture
def tracking():
    from stormfield.analysis.tracking import Bifurcation, TrackedPath, Tracking

    def path(number, kind, start, end, index, ends):
        lam = np.linspace(start, end, 9)
        positions = np.stack([np.cos(lam), np.sin(lam), np.zeros(9)], axis=1)
        return TrackedPath(
            number, f"{kind[0].upper()}{number + 1}", kind, index, lam, positions, np.zeros(9, np.int32),
            np.full((9, 3), 1 / 3), (kind,) * 9, *ends, strength=1.0 + number, rotation=0.0,
        )  # fmt: skip

    paths = (
        path(0, "source", 0.0, 1.0, 1, ("first", "last")),
        path(1, "sink", 0.0, 0.42, 1, ("first", "annihilation")),
        path(2, "saddle", 0.0, 0.42, -1, ("first", "annihilation")),
        path(3, "sink", 0.80, 0.83, 1, ("creation", "annihilation")),
        path(4, "saddle", 0.80, 0.83, -1, ("creation", "annihilation")),
    )
    place = np.array([1.0, 0.0, 0.0])
    events = (
        Bifurcation(0, 0.42, place, "annihilation", "sink", (1, 2)),
        Bifurcation(1, 0.60, place, "hopf", "source", (0,)),
        Bifurcation(2, 0.80, place, "creation", "sink", (3, 4)),
        Bifurcation(3, 0.83, place, "annihilation", "sink", (3, 4)),
    )
    return Tracking(paths, events)


@pytest.fixture
def show(ball, scene, entities):
    from stormfield.scene.write import analysis_objects

    def work(graph=None):
        analysis_objects.show_ecg(scene, ball, graph or entities(), "sf_advection")
        return ball.stormfield.analysis

    return work


def contents(analysis):
    return sorted(obj.name for obj in analysis.collection.objects)


def test_results_are_objects_of_one_collection(ball, show):
    analysis = show()
    assert analysis.collection.name == "Ball analysis" and analysis.collection.hide_render
    assert contents(analysis) == ["Ball Entities", "Ball Periodic Orbits", "Ball Separatrices"]
    assert all(obj.parent == ball for obj in analysis.collection.objects)
    separatrices = bpy.data.objects["Ball Separatrices"].data
    assert [len(curve.points) for curve in separatrices.curves] == [5, 5, 5]
    source, target = (separatrices.attributes[name].data for name in ("source", "target"))
    assert [(a.value, b.value) for a, b in zip(source, target, strict=True)] == [(0, 1), (0, 1), (1, 2)]
    orbit = bpy.data.objects["Ball Periodic Orbits"].data
    assert len(orbit.points) == 24 and orbit.attributes["cyclic"].data[0].value
    points = bpy.data.objects["Ball Entities"].data
    assert np.allclose([v.co for v in points.vertices][:3], np.eye(3))
    assert [a.value for a in points.attributes["strength"].data] == pytest.approx([2.0, 1.0, 0.5, 0.1])


def test_an_update_replaces_and_never_duplicates(ball, show, entities):
    show()
    objects, trees = set(bpy.data.objects.keys()), set(bpy.data.node_groups.keys())
    version = ball.stormfield.analysis.version
    analysis = show(entities(3))
    assert set(bpy.data.objects.keys()) == objects - {"Ball Periodic Orbits"}
    assert set(bpy.data.node_groups.keys()) == trees and len(bpy.data.collections) == 1
    assert len(analysis.ecg.items) == 3 == len(analysis.ecg_tree.nodes)
    assert analysis.version > version
    show()
    assert len(bpy.data.objects) == len(objects)
    assert [len(data) for data in (bpy.data.hair_curves, bpy.data.meshes)] == [2, 2]


def test_the_list_says_what_there_is(show):
    analysis = show()
    assert [item.name for item in analysis.ecg.items] == ["R1", "S2", "A3", "A4"]
    assert [item.kind for item in analysis.ecg.items] == ["source", "saddle", "sink", "attracting"]
    assert analysis.ecg.made and analysis.ecg.lam == pytest.approx(0.25) and analysis.ecg.strongest == 2.0
    assert "2.5 s" in analysis.ecg.items[3].note


def test_filters(show):
    ecg = show().ecg

    def shown():
        return [item.name for item in ecg.items if ecg.passes(item)]

    assert shown() == ["R1", "S2", "A3", "A4"]
    ecg.kinds = {"ATTRACTING"}
    assert shown() == ["A3", "A4"]
    ecg.min_strength = 0.2
    assert shown() == ["A3"]
    ecg.kinds = {"REPELLING", "SADDLE", "ATTRACTING", "OTHER"}
    assert shown() == ["R1", "S2", "A3"]


def test_the_graph_has_three_rows_and_the_overlays_colours(show):
    from stormfield.analysis.colours import KIND_COLOURS

    tree = show().ecg_tree
    assert tree.bl_idname == "StormfieldGraph"
    height = {node.name: node.location[1] for node in tree.nodes}
    assert height["R1"] > height["S2"] > height["A3"] == height["A4"]
    for node in tree.nodes:
        assert tuple(node.color) == pytest.approx(KIND_COLOURS[node.kind]) and node.use_custom_color
    links = {(link.from_node.name, link.to_node.name) for link in tree.links}
    assert links == {("R1", "S2"), ("S2", "A3"), ("R1", "A4")}
    assert all(link.is_hidden for link in tree.links)  # drawn by the editor, from row to row


def test_links_are_drawn_from_row_to_row(show):
    from stormfield.ui import graph_editor

    tree = show().ecg_tree
    lines, colours = graph_editor.link_lines(tree)
    assert lines.shape[1:] == (2, 2) and colours.shape == (*lines.shape[:2], 4)
    bottom, top = lines[..., 1].min(), lines[..., 1].max()
    rows = [node.location[1] for node in tree.nodes]
    assert min(rows) < bottom + 40 and top < max(rows) + 40
    tree.nodes.remove(tree.nodes["S2"])  # by hand, in the editor
    fewer, _ = graph_editor.link_lines(tree)
    assert 0 < len(fewer) < len(lines)


def test_selection_goes_from_list_to_graph_and_back(ball, show):
    from stormfield.scene.write import selection

    analysis = show()
    tree = analysis.ecg_tree
    analysis.ecg.active = 2
    assert [node.name for node in tree.nodes if node.select] == ["A3"] and tree.nodes.active.name == "A3"
    tree.nodes["A3"].select = False
    tree.nodes["S2"].select = True
    tree.nodes.active = tree.nodes["S2"]
    assert selection.follow_graph(ball, "ecg")
    assert analysis.ecg.active == 1 and analysis.ecg.selected().name == "S2"
    assert not selection.follow_graph(ball, "ecg")
    selection.select(ball, "ecg", 0)
    assert tree.nodes.active.name == "R1" and analysis.shown == "ecg"


def test_paths_over_lambda(ball, scene, tracking):
    from stormfield.scene.write import analysis_objects

    analysis_objects.show_tracking(scene, ball, tracking, "sf_advection")
    analysis = ball.stormfield.analysis
    assert contents(analysis) == ["Ball Bifurcations", "Ball Singularity Paths"]
    paths = bpy.data.objects["Ball Singularity Paths"].data
    lam = [a.value for a in paths.attributes["lam"].data]
    assert lam[:9] == pytest.approx(np.linspace(0, 1, 9))
    colours = np.array([a.color for a in paths.attributes["colour"].data])
    assert colours.shape == (45, 4) and (np.diff(colours[:9, :3].sum(axis=1)) > 0).all()  # brighter with λ
    assert [item.name for item in analysis.history.items][:5] == ["S1", "S2", "S3", "S4", "S5"]
    event = analysis.history.items[5]
    assert event.name == "S2 S3 vanish" and event.note == "Saddle and sink vanish"
    analysis.history.min_life = 0.1
    assert [item.name for item in analysis.history.items if analysis.history.passes(item)] == [
        "S1", "S2", "S3", "S2 S3 vanish",
    ]  # fmt: skip


@pytest.fixture
def markers(ball, scene, tracking):
    from stormfield.scene.write import analysis_objects, timeline

    scene.frame_start, scene.frame_end = 1, 101
    bpy.ops.stormfield.key_lambda()
    analysis_objects.show_tracking(scene, ball, tracking, "sf_advection")
    ball.stormfield.analysis.history.kinds |= {"CHANGE"}

    def found():
        timeline.update_markers(ball)
        return sorted((marker.frame, marker.name) for marker in scene.timeline_markers)

    return found


def test_bifurcations_are_markers_at_their_frames(markers):
    assert markers() == [
        (43, "λ 0.42 saddle + sink annihilate"),
        (61, "λ 0.60 becomes source"),
        (81, "λ 0.80 saddle + sink appear"),
        (84, "λ 0.83 saddle + sink annihilate"),
    ]


def test_markers_are_replaced_and_the_artists_own_stay(ball, scene, markers):
    markers()
    scene.timeline_markers.new("mine", frame=43)
    next(m for m in scene.timeline_markers if m.frame == 61).name = "renamed"
    found = markers()
    assert (43, "mine") in found and (61, "renamed") in found
    assert len(found) == 6
    ball.stormfield.analysis.history.min_life = 0.2  # filters the short pair out, at once
    assert sorted(m.frame for m in scene.timeline_markers) == [43, 43, 61, 61]


def test_where_lambda_runs_back_things_happen_backwards(ball, markers):
    from stormfield import compat

    curve = compat.find_fcurve(ball, "stormfield.lam")
    for key, (frame, value) in zip(curve.keyframe_points, ((1, 1.0), (101, 0.0)), strict=True):
        key.co = (frame, value)
    curve.update()
    assert markers()[0] == (18, "λ 0.83 saddle + sink appear")


def test_new_keys_move_the_markers(ball, scene, markers):
    markers()
    scene.frame_end = 201
    bpy.ops.stormfield.key_lambda()
    assert bpy.ops.stormfield.update_markers() == {"FINISHED"}
    assert sorted(marker.frame for marker in scene.timeline_markers) == [85, 121, 161, 167]


def test_without_keys_there_are_no_markers(ball, markers):
    from stormfield import compat

    compat.remove_fcurve(ball, compat.find_fcurve(ball, "stormfield.lam"))
    assert markers() == []


def test_results_stay_with_the_file(ball, show, tmp_path):
    from stormfield.scene.read import results

    show()
    path = str(tmp_path / "a.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)

    ball = bpy.data.objects["Ball"]
    analysis = ball.stormfield.analysis
    assert len(analysis.ecg.items) == 4 and len(analysis.ecg_tree.nodes) == 4
    lines = results.read_curves(ball, results.SEPARATRICES)
    assert [len(line) for line in lines] == [5, 5, 5]


def test_forgetting_leaves_nothing(ball, show):
    from stormfield.scene.write import analysis_objects

    show()
    analysis_objects.forget(ball)
    analysis = ball.stormfield.analysis
    assert not analysis.ecg.items and analysis.ecg_tree is None and analysis.collection is None
    assert [obj.name for obj in bpy.data.objects] == ["Ball"] and not bpy.data.node_groups


def test_a_copy_of_the_object_gets_an_analysis_of_its_own(ball, show, scene, entities):
    from stormfield.scene.write import analysis_objects

    show()
    copy = ball.copy()
    copy.data = ball.data.copy()
    scene.collection.objects.link(copy)
    analysis_objects.show_ecg(scene, copy, entities(2), "sf_advection")
    assert len(ball.stormfield.analysis.ecg_tree.nodes) == 4 and len(copy.stormfield.analysis.ecg_tree.nodes) == 2
    assert ball.stormfield.analysis.collection != copy.stormfield.analysis.collection
    assert len(bpy.data.objects["Ball Entities"].data.vertices) == 4


def test_very_many_paths_are_filtered_by_their_life(ball, scene, tracking):
    from dataclasses import replace

    from stormfield.analysis.tracking import Tracking
    from stormfield.scene.write import analysis_objects

    long, short = tracking.paths[0], tracking.paths[3]
    paths = tuple(replace(long if i % 3 == 0 else short, id=i) for i in range(500))
    hidden = analysis_objects.show_tracking(scene, ball, Tracking(paths, ()), "sf_advection")
    history = ball.stormfield.analysis.history
    shown = sum(history.passes(item) for item in history.items)
    assert (shown, hidden) == (167, 333)


def test_removing_the_field_removes_its_analysis(ball, show, markers):
    show()
    assert markers()
    assert bpy.ops.stormfield.remove_field() == {"FINISHED"}
    assert [obj.name for obj in bpy.data.objects] == ["Ball"] and not bpy.data.node_groups
    assert not bpy.context.scene.timeline_markers


def test_nodes_of_a_graph_that_were_deleted_or_copied_come_back(rings, native):
    """X in the graph once took a saddle's node away as if the field had none."""
    from stormfield.scene.nodes import entity_nodes

    bpy.ops.stormfield.analyze()
    tree = rings.stormfield.analysis.ecg_tree
    before = {node.name: (node.entity, node.kind, tuple(node.location)) for node in tree.nodes}
    links = {(link.from_node.name, link.to_node.name) for link in tree.links}
    assert entity_nodes.is_whole(tree) and len(before) > 2
    gone = next(iter(before))
    tree.nodes.remove(tree.nodes[gone])
    tree.nodes.new(entity_nodes.NODE).name = "copy"
    assert not entity_nodes.is_whole(tree)
    entity_nodes.make_whole(tree)
    assert entity_nodes.is_whole(tree)
    assert {node.name: (node.entity, node.kind, tuple(node.location)) for node in tree.nodes} == before
    assert {(link.from_node.name, link.to_node.name) for link in tree.links} == links


def test_blender_tells_the_graph_of_a_deleted_node(rings, native, monkeypatch):
    from stormfield.ui import graph_editor

    asked = []
    monkeypatch.setattr(graph_editor, "_repair_soon", asked.append)
    bpy.ops.stormfield.analyze()
    assert not asked  # making the graph is no damage
    tree = rings.stormfield.analysis.ecg_tree
    tree.nodes.remove(tree.nodes[0])
    assert tree.session_uid in asked


def test_nodes_of_a_graph_are_wide_enough_for_the_longest_name():
    from stormfield.scene.nodes import entity_nodes

    assert entity_nodes.width_for(["A1", "S12"]) == entity_nodes.WIDTH
    assert entity_nodes.width_for(["A1", "Spiral Out.001"]) > entity_nodes.width_for(["A1", "Spiral Out"]) > 100
    assert entity_nodes.width_for(["long " * 40]) == entity_nodes.WIDEST
    assert entity_nodes.width_for([]) == entity_nodes.WIDTH


def test_graph_list_marks_and_legend_show_the_same(rings, native):
    """Weak orbits stayed in the graph when Detail had taken them out of list and view."""
    from stormfield.ui import analysis_drawing, graph_editor

    bpy.ops.stormfield.analyze()
    analysis = rings.stormfield.analysis
    analysis.ecg.items[1].weight = 0.5  # as of an orbit below the accuracy
    counts = set()
    for detail in (1.0, 0.5, 0.0):
        analysis.detail = detail
        listed = [item.name for item in analysis.ecg.items if analysis.ecg.passes(item)]
        counts.add(len(listed))
        assert sorted(node.name for node in analysis.ecg_tree.nodes) == sorted(listed)
        bpy.context.view_layer.update()
        drawing = analysis_drawing.drawing_of(rings.evaluated_get(bpy.context.evaluated_depsgraph_get()))
        assert [mark.name for mark in drawing.entities] == listed
        assert drawing.counts["ecg"].total() == len(listed)
        assert f"{len(listed)} shown" in graph_editor.summary(analysis.ecg)
        ends = {end for route in analysis.ecg_tree.drawn for end in (route.source, route.target)}
        assert ends <= set(listed)
    assert len(counts) > 1
    analysis.ecg.kinds = {"SADDLE"}
    assert all(node.kind == "saddle" for node in analysis.ecg_tree.nodes)
