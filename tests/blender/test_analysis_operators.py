# SPDX-License-Identifier: GPL-3.0-or-later
"""Analyses as an artist starts them: from a field on the mesh, from a solved cache; and what they report."""

import bpy
import numpy as np
import pytest

pytest.importorskip("igraph", reason="igraph is not installed")
pytestmark = pytest.mark.usefixtures("native")


def vertices(obj):
    return np.array([vertex.co for vertex in obj.data.vertices], np.float64)


@pytest.fixture
def dipole(ball, put_field):
    """A source at the south pole, a sink at the north pole: flow along the meridians, turning a little."""
    places = vertices(ball)
    up = np.array([0.0, 0.0, 1.0])
    put_field(ball, up - places * places[:, 2:] + 0.5 * np.cross(up, places))
    return ball


@pytest.fixture
def rings(ball, put_field):
    """The equator attracts, both poles repel: one attracting orbit between two sources."""
    places = vertices(ball)
    up = np.array([0.0, 0.0, 1.0])
    put_field(ball, np.cross(up, places) - places[:, 2:] * (up - places * places[:, 2:]))
    return ball


def test_analyze_at_this_frame(dipole):
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}
    analysis = dipole.stormfield.analysis
    assert sorted(item.kind for item in analysis.ecg.items) == ["sink", "source"]
    source = next(item for item in analysis.ecg.items if item.kind == "source")
    assert source.position[2] == pytest.approx(-1.0, abs=0.02)
    links = [(link.from_node.kind, link.to_node.kind) for link in analysis.ecg_tree.links]
    assert links == [("source", "sink")]


def test_a_periodic_orbit_is_a_closed_curve(rings):
    bpy.ops.stormfield.analyze()
    kinds = sorted(item.kind for item in rings.stormfield.analysis.ecg.items)
    assert kinds == ["attracting", "source", "source"]
    orbit = bpy.data.objects["Ball Periodic Orbits"].data
    assert orbit.attributes["cyclic"].data[0].value
    assert max(abs(point.position[2]) for point in orbit.points) < 0.03


def test_undo_brings_the_earlier_analysis_back(dipole, put_field):
    bpy.ops.stormfield.analyze()
    bpy.ops.ed.undo_push(message="one")
    places = vertices(dipole)
    put_field(dipole, np.cross([0, 0, 1.0], places) - places[:, 2:] * ([0, 0, 1.0] - places * places[:, 2:]))
    bpy.ops.stormfield.analyze()
    bpy.ops.ed.undo_push(message="two")
    assert len(bpy.data.objects["Ball"].stormfield.analysis.ecg.items) == 3
    bpy.ops.ed.undo()
    analysis = bpy.data.objects["Ball"].stormfield.analysis
    assert len(analysis.ecg.items) == 2 and len(analysis.ecg_tree.nodes) == 2


def test_nothing_to_analyze_says_so(ball):
    for operator in (bpy.ops.stormfield.analyze, bpy.ops.stormfield.morse_sets, bpy.ops.stormfield.analyze_lambda):
        with pytest.raises(RuntimeError, match="Solve first"):
            operator()
    with pytest.raises(RuntimeError, match="Nothing was analyzed"):
        bpy.ops.stormfield.forget_analysis()


def test_a_field_that_is_not_finite_names_the_vertex(dipole, put_field):
    values = vertices(dipole)
    values[7] = np.nan
    put_field(dipole, values)
    with pytest.raises(RuntimeError, match="vertex 7"):
        bpy.ops.stormfield.morse_sets()


def test_a_field_of_zeros(dipole, put_field):
    put_field(dipole, 0 * vertices(dipole))
    with pytest.raises(RuntimeError, match="zero everywhere"):
        bpy.ops.stormfield.morse_sets()


@pytest.mark.parametrize("method", ["geometry", "tau", "spatial"])
def test_morse_sets(dipole, method):
    dipole.stormfield.morse.method = method
    assert bpy.ops.stormfield.morse_sets() == {"FINISHED"}
    analysis = dipole.stormfield.analysis
    assert {item.kind for item in analysis.mcg.items} >= {"sink", "source"}
    assert analysis.shown == "mcg" and len(analysis.mcg_tree.nodes) == len(analysis.mcg.items)
    sets = np.array([face.value for face in dipole.data.attributes["sf_morse"].data])
    counted = [int((sets == i).sum()) for i in range(len(analysis.mcg.items))]
    assert counted == [item.faces for item in analysis.mcg.items]
    north = np.array([polygon.center[2] > 0.95 for polygon in dipole.data.polygons])
    sink = next(i for i, item in enumerate(analysis.mcg.items) if item.kind == "sink")
    assert (sets[north] == sink).any() and not (sets[~north] == sink).all()


def test_morse_sets_again_replace_the_first(dipole):
    bpy.ops.stormfield.morse_sets()
    names = [obj.name for obj in bpy.data.objects], bpy.data.node_groups.keys()
    dipole.stormfield.morse.method = "geometry"
    bpy.ops.stormfield.morse_sets()
    assert ([obj.name for obj in bpy.data.objects], bpy.data.node_groups.keys()) == names
    assert len([a for a in dipole.data.attributes if a.name.startswith("sf_morse")]) == 1


def test_the_slider_simplifies_by_persistence(rings):
    morse = rings.stormfield.morse
    morse.method = "geometry"
    bpy.ops.stormfield.morse_sets()
    items = rings.stormfield.analysis.mcg.items
    before = len(items)
    assert before >= 3
    morse.simplify = 100.0
    assert len(items) < before
    morse.simplify = 0.0
    assert len(items) == before


def test_the_preview_writes_nothing(dipole):
    from stormfield.session import morse_preview

    dipole.stormfield.morse.live = True
    preview = morse_preview.of(dipole)
    assert preview is not None and {"sink", "source"} <= set(preview.kinds)
    assert "sf_morse" not in dipole.data.attributes and not dipole.stormfield.analysis.mcg.made
    dipole.stormfield.morse.live = False
    assert morse_preview.of(dipole) is None


def test_analyze_over_lambda(storms):
    if not bpy.app.build_options.usd:
        pytest.skip("this Blender has no USD")
    storms.stormfield.solve.even_speed = 0.0
    bpy.ops.stormfield.solve()
    assert bpy.ops.stormfield.analyze_lambda() == {"FINISHED"}
    history = storms.stormfield.analysis.history
    paths = [item for item in history.items if item.lam_end > item.lam_start]
    whole = [item for item in paths if item.life > 0.99]
    assert len(whole) >= 2 and storms.stormfield.analysis.shown == "history"
    assert all(0.0 <= item.lam_start <= item.lam_end <= 1.0 for item in paths)


def test_going_to_a_bifurcation_goes_to_its_frame(ball, scene):
    from stormfield.analysis.tracking import Bifurcation, Tracking
    from stormfield.scene.write import analysis_objects

    scene.frame_start, scene.frame_end = 1, 101
    bpy.ops.stormfield.key_lambda()
    event = Bifurcation(0, 0.42, np.array([1.0, 0, 0]), "annihilation", "sink", ())
    analysis_objects.show_tracking(scene, ball, Tracking((), (event,)), "sf_advection")
    with pytest.raises(RuntimeError, match="Select an entity"):
        ball.stormfield.analysis.shown = "history"
        bpy.ops.stormfield.go_to_entity()
    assert bpy.ops.stormfield.select_entity(which="history", index=0) == {"FINISHED"}
    bpy.ops.stormfield.go_to_entity()
    assert scene.frame_current == 43


def test_the_overlay_gets_lines_marks_and_faces(rings):
    from stormfield.ui import analysis_drawing, analysis_overlay

    bpy.ops.stormfield.morse_sets()
    evaluated = rings.evaluated_get(bpy.context.evaluated_depsgraph_get())
    drawing = analysis_drawing.drawing_of(evaluated)
    assert drawing is analysis_drawing.drawing_of(evaluated)  # kept
    faces = drawing.faces
    assert len(faces.corners) == len(faces.colours) and len(faces.corners) % 3 == 0
    assert len(faces.border) == len(faces.border_sets) > 0
    assert len(drawing.marks) == len(rings.stormfield.analysis.mcg.items)
    assert any(block.title.startswith("Regions") for block in analysis_overlay.legend_blocks(rings, evaluated))
    rings.stormfield.analysis.mcg.kinds = {"ATTRACTING"}
    fewer = analysis_drawing.drawing_of(evaluated)
    assert fewer is not drawing and 0 < len(fewer.faces.corners) < len(faces.corners)


@pytest.fixture
def looking(monkeypatch):
    """A view of 400 × 400 pixels along -Y onto the square from -2 to 2, without a window; nothing hides anything."""
    from types import SimpleNamespace

    from mathutils import Matrix
    from stormfield.ui import pick

    monkeypatch.setattr(pick, "_hidden", lambda _context, _evaluated, place: place[1] > 0.1)
    turned = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
    return SimpleNamespace(
        region=SimpleNamespace(width=400, height=400),
        region_data=SimpleNamespace(perspective_matrix=Matrix.Diagonal((0.5, 0.5, 0.1, 1.0)) @ turned),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )


def test_a_click_hits_the_nearest_entity_in_front(rings, looking):
    from stormfield.analysis.tracking import Bifurcation, Tracking
    from stormfield.scene.write import analysis_objects
    from stormfield.ui import pick

    places = ((0.0, -1.0, 0.0), (0.08, -0.997, 0.0), (0.5, 0.866, 0.0))  # the last on the far side
    events = tuple(Bifurcation(i, 0.5, np.array(place), "creation", "sink", ()) for i, place in enumerate(places))
    analysis_objects.show_tracking(bpy.context.scene, rings, Tracking((), events), "sf_advection")
    rings.stormfield.analysis.shown = "history"
    evaluated = rings.evaluated_get(bpy.context.evaluated_depsgraph_get())

    def at(x, z):
        return pick.entity_at(looking, rings, evaluated, (200 + 100 * x, 200 + 100 * z))

    assert at(0.0, 0.02) == ("history", 0)
    assert at(0.09, 0.0) == ("history", 1)
    assert at(0.5, 0.0) is None and at(-0.5, 0.5) is None


def test_a_smoothed_mesh_shows_the_analysis_of_its_own_vertices(dipole):
    """Subdivision changes what is seen, not what the field lives on."""
    from stormfield.ui import analysis_drawing

    dipole.modifiers.new("Smooth", "SUBSURF").levels = 1
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}
    assert bpy.ops.stormfield.morse_sets() == {"FINISHED"}
    assert len(dipole.data.attributes["sf_morse"].data) == len(dipole.data.polygons)
    evaluated = dipole.evaluated_get(bpy.context.evaluated_depsgraph_get())
    drawing = analysis_drawing.drawing_of(evaluated)
    assert len(evaluated.data.vertices) > len(dipole.data.vertices)
    assert drawing.faces is not None and len(drawing.entities) == 2
    size = np.linalg.norm([mark.position for mark in drawing.entities], axis=1)
    assert (size > 0.97).all() and (size < 1.03).all()


@pytest.mark.parametrize("method", ["geometry", "tau", "spatial"])
def test_refinement(rings, method):
    rings.stormfield.morse.method = method
    assert bpy.ops.stormfield.refine_morse() == {"FINISHED"}
    kinds = [item.kind for item in rings.stormfield.analysis.mcg.items]
    assert kinds.count("source") == 2 and "attracting" in kinds


def test_what_is_refined_holds_within_the_error_and_can_be_simplified(rings):
    from stormfield.session import morse_state

    morse = rings.stormfield.morse
    morse.eps = 1.0
    morse.persistence = True
    assert bpy.ops.stormfield.refine_morse() == {"FINISHED"}
    decomposition = morse_state.of(rings).found.decomposition
    assert decomposition.eps > 0.0 and any(s.persistence for s in decomposition.sets)
    kinds = [item.kind for item in rings.stormfield.analysis.mcg.items]
    assert "source" in kinds and "attracting" in kinds
    assert not morse_state.why_no_simplification(rings)
    morse.simplify = 100.0
    assert len(rings.stormfield.analysis.mcg.items) < len(kinds)
    morse.method = "tau"
    bpy.ops.stormfield.refine_morse()
    assert "cannot be simplified" in morse_state.why_no_simplification(rings)


def test_one_set_is_refined_by_itself(rings):
    with pytest.raises(RuntimeError, match="first"):
        bpy.ops.stormfield.refine_set()
    rings.stormfield.morse.method = "geometry"
    bpy.ops.stormfield.morse_sets()
    mcg = rings.stormfield.analysis.mcg
    with pytest.raises(RuntimeError, match="Select a region"):
        bpy.ops.stormfield.refine_set()
    mcg.active = max(range(len(mcg.items)), key=lambda i: mcg.items[i].faces)
    before = {item.faces for i, item in enumerate(mcg.items) if i != mcg.active}
    assert bpy.ops.stormfield.refine_set() == {"FINISHED"}
    assert before <= {item.faces for item in mcg.items}  # the others are as they were


@pytest.fixture
def half_flowing(put_field):
    """Two balls in one mesh, of which the second has no field."""
    for x in (0.0, 4.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(x, 0.0, 0.0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.join()
    bpy.ops.object.transform_apply()
    obj = bpy.context.object
    bpy.ops.stormfield.add_field()

    def vectors(places):
        up = np.array([0.0, 0.0, 1.0])
        swirl = np.cross(up, places) - places[:, 2:] * (up - places * places[:, 2:])
        middle = places[:, 0].mean()
        return np.where((places[:, 0] < middle)[:, None], swirl, 0.0)

    put_field(obj, vectors)
    return obj


def test_a_part_without_a_field_is_in_no_list(half_flowing, native):
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}
    analysis = half_flowing.stormfield.analysis
    assert len(analysis.ecg.items) == len(analysis.ecg_tree.nodes) < 6
    assert not [item for item in analysis.ecg.items if item.kind == "degenerate"]
