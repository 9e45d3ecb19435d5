# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements are read where they are, whatever the window shows of them, and turn as the artist sees the surface."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix

PLACE = (1.0, 0.0, 0.0)


@pytest.fixture
def read(scene):
    from stormfield.scene.read.design import read_design

    return lambda obj: read_design(bpy.context, obj)[1]


def add(obj, source, **settings):
    from stormfield.scene.write.elements import add_element

    return add_element(obj, source, **settings)


def reopened(tmp_path):
    """The file as it is after it was saved and opened: what is not shown was never evaluated."""
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.data.objects["Ball"]


def control(collection, name="Eye", parented=True):
    """An empty at PLACE that a parent carries there."""
    empty = bpy.data.objects.new(name, None)
    collection.objects.link(empty)
    if parented:
        parent = bpy.data.objects.new(f"{name} Parent", None)
        collection.objects.link(parent)
        parent.location, empty.parent, empty.location = (0.5, 0.0, 0.0), parent, (0.5, 0.0, 0.0)
    else:
        empty.location = PLACE
    return empty


def uncheck(collection, _empty):
    bpy.context.view_layer.layer_collection.children[collection.name].exclude = True


def disable(collection, _empty):
    collection.hide_viewport = True


def hide(collection, _empty):
    bpy.context.view_layer.layer_collection.children[collection.name].hide_viewport = True


def disable_object(_collection, empty):
    empty.hide_viewport = True
    if empty.parent:
        empty.parent.hide_viewport = True


def hide_by_eye(_collection, empty):
    empty.hide_set(True)


def move_to_other_scene(collection, _empty):
    other = bpy.data.scenes.new("Other")
    other.collection.children.link(collection)
    bpy.context.scene.collection.children.unlink(collection)


def take_out_of_all_scenes(collection, _empty):
    collection.use_fake_user = True
    bpy.context.scene.collection.children.unlink(collection)


HIDING = [uncheck, disable, hide, disable_object, hide_by_eye, move_to_other_scene, take_out_of_all_scenes]


@pytest.mark.parametrize("put_away", HIDING)
@pytest.mark.parametrize("parented", [True, False])
def test_controls_that_are_not_shown_keep_their_place(ball, read, scene, tmp_path, put_away, parented):
    collection = bpy.data.collections.new("Controls")
    scene.collection.children.link(collection)
    empty = control(collection, parented=parented)
    add(ball, empty)
    put_away(collection, empty)
    obj = reopened(tmp_path)
    before = set(bpy.data.objects), set(bpy.data.scenes)
    assert np.allclose(read(obj).elements[0].points[0], PLACE, atol=1e-6)
    assert (set(bpy.data.objects), set(bpy.data.scenes)) == before


def test_a_constrained_and_keyed_control_that_is_not_shown_is_followed(ball, read, scene, tmp_path):
    collection = bpy.data.collections.new("Controls")
    scene.collection.children.link(collection)
    empty, goal = control(collection, parented=False), control(collection, "Goal", parented=False)
    empty.location = (0, 0, 0)
    empty.constraints.new("COPY_LOCATION").target = goal
    for frame, x in ((1, 1.0), (50, -1.0)):
        goal.location = (x, 0, 1)
        goal.keyframe_insert("location", frame=frame)
    add(ball, empty, from_animation=True)
    uncheck(collection, empty)
    element = read(reopened(tmp_path)).elements[0]
    assert np.allclose(element.points[0], (1, 0, 1), atol=1e-6)
    assert np.allclose(element.points[-1], (-1, 0, 1), atol=1e-6)
    assert bpy.context.scene.frame_current == 1


def test_a_curve_that_is_not_shown_is_read_in_place(ball, read, scene, add_curve, tmp_path):
    curve = add_curve([(0, 0, 0), (0, 1, 0)])
    collection = bpy.data.collections.new("Controls")
    scene.collection.children.link(collection)
    scene.collection.objects.unlink(curve)
    collection.objects.link(curve)
    curve.location = (1, 0, 0)
    add(ball, curve, type="streamline")
    uncheck(collection, curve)
    points = read(reopened(tmp_path)).elements[0].points
    assert np.allclose(points, [(1, 0, 0), (1, 1, 0)], atol=1e-6)


def test_a_field_that_is_not_shown_is_read_in_its_own_space(ball, read, scene, tmp_path):
    empty = control(scene.collection, parented=False)
    empty.location = (4, 0, 0)
    ball.location = (3, 0, 0)
    add(ball, empty)
    collection = bpy.data.collections.new("Fields")
    scene.collection.children.link(collection)
    for old in ball.users_collection:
        old.objects.unlink(ball)
    collection.objects.link(ball)
    uncheck(collection, None)
    assert np.allclose(read(reopened(tmp_path)).elements[0].points[0], PLACE, atol=1e-6)


def test_an_object_appended_without_its_controls_in_the_scene_finds_them(ball, read, scene, tmp_path):
    empty = control(scene.collection)
    add(ball, empty)
    library = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library) as (_there, here):
        here.objects = ["Ball"]
    obj = here.objects[0]
    bpy.context.scene.collection.objects.link(obj)
    assert np.allclose(read(obj).elements[0].points[0], PLACE, atol=1e-6)


@pytest.mark.parametrize("negative", [(-1, 1, 1), (1, -2, 1), (-1, -1, -1)])
@pytest.mark.parametrize("by_parent", [False, True])
def test_left_seen_from_outside_mirrors_with_the_object(ball, read, scene, negative, by_parent):
    if by_parent:
        parent = bpy.data.objects.new("Mirror", None)
        scene.collection.objects.link(parent)
        ball.parent = parent
        parent.scale = negative
    else:
        ball.scale = negative
    empty = control(scene.collection, parented=False)
    add(ball, empty, kind="spiral_in_ccw", angle=0.3)
    bpy.context.view_layer.update()
    element = read(ball).elements[0]
    assert element.kind == "spiral_in_cw"
    assert element.angle == pytest.approx(-0.3)


def test_two_negative_axes_turn_and_do_not_mirror(ball, read, scene):
    ball.scale = (-1, -1, 1)
    add(ball, control(scene.collection, parented=False), kind="vortex_ccw")
    bpy.context.view_layer.update()
    assert read(ball).elements[0].kind == "vortex_ccw"


def test_a_mirrored_vortex_turns_left_in_the_world(ball, scene, attribute, native):
    ball.scale = (-1, 1, 1)
    bpy.context.view_layer.update()
    empty = control(scene.collection, parented=False)
    empty.location = (0, 0, 1)
    add(ball, empty, kind="vortex_ccw", radius=0.4)
    ball.stormfield.solve.samples = 2
    bpy.ops.stormfield.solve()
    to_world = np.array(ball.matrix_world.to_3x3())
    points = np.array([vertex.co for vertex in ball.data.vertices]) @ to_world.T
    flow = attribute(ball, "sf_advection") @ to_world.T
    near = (np.linalg.norm(points - (0, 0, 1), axis=1) < 0.3) & (np.hypot(points[:, 0], points[:, 1]) > 0.05)
    left = np.cross((0, 0, 1), points[near])
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    turn = np.einsum("ij,ij->i", left, flow[near]) / np.linalg.norm(flow[near], axis=1)
    assert turn.min() > 0.9


def test_a_saddle_keeps_its_axis_in_the_world_when_mirrored(ball, read, scene):
    empty = control(scene.collection, parented=False)
    empty.location = (0, 0, 1)
    add(ball, empty, kind="saddle", angle=math.radians(30))
    plain = read(ball).elements[0]
    ball.scale = (1, -1, 1)
    bpy.context.view_layer.update()
    mirrored = read(ball).elements[0]
    out = [
        np.array(Matrix.Rotation(element.angle, 3, "Z")) @ np.array(element.direction) for element in (plain, mirrored)
    ]
    assert np.allclose(out[0], out[1] * (1, -1, 1), atol=1e-6)


def sketch():
    pencils = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)
    pencil = pencils.new("Sketch")
    drawing = pencil.layers.new("Drawn").frames.new(1).drawing
    drawing.add_strokes([2])
    for point, x in zip(drawing.strokes[0].points, (0.0, 1.0), strict=True):
        point.position = (x, 0.0, 1.0)
    return bpy.data.objects.new("Sketch", pencil)


def hair():
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([3])
    return bpy.data.objects.new("Hair", curves)


def text():
    letter = bpy.data.curves.new("Text", "FONT")
    letter.body = "I"
    return bpy.data.objects.new("Text", letter)


@pytest.mark.parametrize("make", [sketch, hair, text])
def test_what_artists_draw_with_is_added_from_selected(ball, read, scene, make):
    source = make()
    scene.collection.objects.link(source)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    source.select_set(True)
    assert bpy.ops.stormfield.add_elements.poll()
    bpy.ops.stormfield.add_elements()
    element = ball.stormfield.elements[0]
    assert element.source == source
    assert len(read(ball).elements) >= 1
    if make is sketch:
        assert np.allclose(read(ball).elements[0].points, [(0, 0, 1), (1, 0, 1)], atol=1e-6)
