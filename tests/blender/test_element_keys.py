# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of elements that are keyed, fade, or belong to lines and orbits, as a solve reads them."""

import bpy
import numpy as np
import pytest
from stormfield.model.errors import InputError


def circle(count=32, latitude=0.0):
    angles = np.arange(count) * 2.0 * np.pi / count
    return [(np.cos(latitude) * np.cos(a), np.cos(latitude) * np.sin(a), np.sin(latitude)) for a in angles]


@pytest.fixture
def storm(ball):
    """A vortex on an empty, with λ keyed over the scene."""
    from stormfield.scene.write.elements import add_element
    from stormfield.scene.write.lambda_keys import key_lambda_over_scene

    key_lambda_over_scene(bpy.context.scene, ball)
    empty = bpy.data.objects.new("Eye", None)
    empty.location = (1, 0, 0)
    bpy.context.scene.collection.objects.link(empty)
    return add_element(ball, empty, type="singular", kind="vortex_ccw", radius=0.3)


def read(obj):
    from stormfield.scene.read.design import read_design

    return read_design(bpy.context, obj)[1].elements


def key(obj, index, name, *pairs):
    for frame, value in pairs:
        setattr(obj.stormfield.elements[index], name, value)
        obj.keyframe_insert(f"stormfield.elements[{index}].{name}", frame=frame)


def test_keyed_strength_becomes_a_list_over_lambda(ball, storm):
    key(ball, 0, "strength", (1, 0.1), (25.5, 0.5), (50, 0.2))
    before = bpy.context.scene.frame_current
    (element,) = read(ball)
    assert bpy.context.scene.frame_current == before
    assert element.lam[0] == 0.0 and element.lam[-1] == 1.0 and len(element.lam) == len(element.strength)
    assert np.interp((0.0, 0.5, 1.0), element.lam, element.strength) == pytest.approx((0.1, 0.5, 0.2), abs=0.01)
    assert element.radius == pytest.approx(0.3)
    element.check()


def test_keys_count_at_the_lambda_that_is_seen(ball, storm):
    # λ stands at 0 until frame 30: strength at frame 30 is that of λ 0, or nearly.
    from stormfield import compat

    curve = compat.find_fcurve(ball, "stormfield.lam")
    curve.keyframe_points[0].co = (30, 0.0)
    curve.update()
    key(ball, 0, "strength", (30, 0.1), (50, 0.3))
    for each in compat.fcurves(ball):
        for point in each.keyframe_points:
            point.interpolation = "LINEAR"
    (element,) = read(ball)
    assert np.interp((0.0, 0.5, 1.0), element.lam, element.strength) == pytest.approx((0.1, 0.2, 0.3), abs=0.01)


def test_a_moving_element_has_its_place_at_every_stop(ball, storm, add_curve):
    from stormfield.scene.write.elements import add_element

    moving = add_element(ball, add_curve(circle()[:9], "Path"), type="singular", kind="source", lam_end=0.5)
    index = len(ball.stormfield.elements) - 1
    key(ball, index, "radius", (1, 0.2), (50, 0.4))
    element = read(ball)[index]
    assert moving.name == element.name and len(element.points) == len(element.lam) == len(element.radius)
    assert element.lam[-1] == 0.5 and np.interp(0.5, element.lam, element.radius) < 0.35
    element.check()


def test_drivers_count_like_keys(ball, storm):
    driver = ball.driver_add("stormfield.elements[0].strength").driver
    driver.expression = "0.1 + 0.01 * frame"
    (element,) = read(ball)
    assert element.strength[0] == pytest.approx(0.11) and element.strength[-1] == pytest.approx(0.6)


def test_keys_without_lambda_say_so(ball, storm):
    from stormfield import compat

    key(ball, 0, "strength", (1, 0.1), (50, 0.5))
    compat.remove_fcurve(ball, compat.find_fcurve(ball, "stormfield.lam"))
    with pytest.raises(InputError, match="has no keyframes; key it twice"):
        read(ball)


def test_a_field_stays_fresh_at_other_frames_but_not_with_other_keys(ball, storm):
    from stormfield.scene.read import freshness

    key(ball, 0, "strength", (1, 0.1), (50, 0.5))
    bpy.context.scene.frame_set(1)
    before = freshness.read(ball)
    bpy.context.scene.frame_set(40)
    assert freshness.changes(before, freshness.read(ball)) == []
    key(ball, 0, "strength", (50, 0.9))
    assert freshness.changes(before, freshness.read(ball)) == ["'Eye' was changed"]


def test_lines_and_orbits_are_read(ball, storm, add_curve):
    from stormfield.scene.write.elements import add_element

    add_element(
        ball, add_curve(circle(), "Ring", cyclic=True), type="orbit", orbit_kind="repelling", pull=7.0, reverse=True
    )
    add_element(ball, add_curve(circle()[:9], "Line"), type="attachment", pull=3.0, fade_in=0.25)
    add_element(ball, ball.stormfield.elements[0].source, type="separation", name="Arrow")
    _, ring, line, arrow = read(ball)
    assert (ring.type, ring.kind, ring.pull, ring.reverse) == ("orbit", "repelling", 7.0, True)
    assert ring.points[0] == ring.points[-1]
    assert (line.type, line.rate, line.fade_in) == ("attachment", 3.0, 0.25) and len(line.points) == 9
    assert len(arrow.points) == 1 and arrow.direction is not None


def test_a_stroke_that_is_no_loop_is_refused(ball, storm, add_curve):
    from stormfield.scene.write.elements import add_element

    add_element(ball, add_curve(circle()[:17], "Half"), type="orbit")
    with pytest.raises(InputError, match="'Half': its curve is not closed, its ends are 2 apart; close it"):
        read(ball)
    ball.stormfield.elements[1].source = ball.stormfield.elements[0].source
    with pytest.raises(InputError, match="'Half' goes round a loop, but its source is an empty"):
        read(ball)


def test_a_bifurcation_happens_at_the_lambda_that_is_shown(ball):
    ball.stormfield.lam = 0.4
    bpy.context.scene.cursor.location = (2, 0, 0)
    assert bpy.ops.stormfield.place_bifurcation(kind="hopf_birth") == {"FINISHED"}
    (element,) = read(ball)
    assert (element.type, element.kind) == ("bifurcation", "hopf_birth")
    assert element.lam == pytest.approx((0.4,)) and len(element.points) == 1 and element.direction is not None
    assert element.points[0] == pytest.approx((1, 0, 0), abs=0.02)
    element.check()
    ball.stormfield.elements[0].from_animation = True
    with pytest.raises(InputError, match="happens at one λ; turn From Animation off"):
        read(ball)


def test_brush_strokes_are_read_and_their_order_counts(ball, storm, add_curve):
    from stormfield.scene.read import freshness
    from stormfield.scene.write.elements import add_element

    add_element(ball, add_curve(circle()[:9], "Comb"), type="brush", mode="add", falloff=0.25)
    add_element(ball, add_curve(circle(latitude=0.5)[:9], "Calm"), type="brush", mode="smooth")
    _, comb, calm = read(ball)
    assert (comb.type, comb.mode, comb.falloff, calm.mode) == ("brush", "add", 0.25, "smooth")
    before = freshness.read(ball)
    ball.stormfield.elements.move(0, 2)
    assert freshness.changes(before, freshness.read(ball)) == []
    ball.stormfield.elements.move(0, 1)
    assert freshness.changes(before, freshness.read(ball)) == ["brush strokes were put in another order"]


def test_orbits_and_lines_are_drawn(ball, storm, add_curve, native):
    from stormfield.scene.write.elements import add_element
    from stormfield.ui import element_drawing

    source = storm.source
    add_element(ball, add_curve(circle(), "Ring", cyclic=True), type="orbit")
    add_element(ball, add_curve(circle()[:9], "Line"), type="separation")
    for kind in ("vanish_source", "hopf_birth"):
        add_element(ball, source, name=kind, type="bifurcation", bifurcation_kind=kind, radius=0.4)
    bpy.context.view_layer.update()

    def shape(name):
        drawing = element_drawing.drawing_of(ball.evaluated_get(bpy.context.evaluated_depsgraph_get()))
        return next(shape for shape in drawing.shapes if shape.name == name)

    assert len(shape("vanish_source").at(0.5)) > 40 and len(shape("hopf_birth").at(0.0)) > 80
    first = shape("Ring").fixed
    assert len(first) > 100 and len(shape("Line").fixed) > 20
    ball.stormfield.elements[1].reverse = True
    assert not np.array_equal(shape("Ring").fixed, first)


@pytest.mark.parametrize("kind", ["attracting", "repelling"])
def test_a_loop_around_suzannes_ear_becomes_its_orbit(scene, add_curve, native, kind):
    """One orbit of the kind, within a quarter of the strip's width of the loop."""
    from stormfield.scene.read.design import read_design
    from stormfield.scene.write.elements import add_element
    from stormfield.solve import solve

    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    bpy.ops.stormfield.add_field()
    loop = ear_loop(obj)
    add_element(obj, add_curve(loop, "Ear", cyclic=True), type="orbit", orbit_kind=kind)
    obj.stormfield.solve.samples = 2
    mesh, design = read_design(bpy.context, obj)
    field = solve(mesh, design).fields["advection"].sample(0)
    topology = native.topology(field)
    closed = np.array([*loop, loop[0]])
    radius = obj.stormfield.elements[0].radius
    near = [orbit for orbit in topology.periodic_orbits if distances(closed, orbit.points).min() < 0.5 * radius]
    assert [orbit.kind for orbit in near] == [kind]
    assert distances(closed, near[0].points).max() < 0.5 * radius
    assert (near[0].multiplier < 1.0) == (kind == "attracting")


def ear_loop(obj):
    """Where an upright plane cuts the left ear."""
    import bmesh
    from stormfield.scene.read.curves import chains

    shape = bmesh.new()
    shape.from_mesh(obj.data)
    cut = bmesh.ops.bisect_plane(
        shape, geom=[*shape.verts, *shape.edges, *shape.faces], plane_co=(1.0, 0.0, 0.0), plane_no=(1.0, 0.0, 0.0)
    )["geom_cut"]
    edges = [each for each in cut if isinstance(each, bmesh.types.BMEdge)]
    places = {vertex: number for number, vertex in enumerate({v for edge in edges for v in edge.verts})}
    points = np.array([vertex.co[:] for vertex in places])
    lines = list(chains(points, np.array([[places[v] for v in edge.verts] for edge in edges])))
    shape.free()
    line = max(lines, key=len)
    assert np.array_equal(line[0], line[-1])
    return [tuple(point) for point in line[:-1]]


def distances(line, points):
    points = np.asarray(points)
    along = np.diff(line, axis=0)
    lengths = np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip(((points[:, None] - line[None, :-1]) * along).sum(axis=2) / lengths, 0.0, 1.0)
    return np.linalg.norm(line[None, :-1] + share[..., None] * along - points[:, None], axis=2).min(axis=1)
