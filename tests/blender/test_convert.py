# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes become plain data: places in the mesh's space, λ from keys, messages that name object and cure."""

import itertools
import math

import bpy
import numpy as np
import pytest

convert_scene = pytest.importorskip("stormfield.scene.read.design")


@pytest.fixture
def read(scene):
    from stormfield.scene.read.design import read_design

    return lambda obj: read_design(bpy.context, obj)


@pytest.fixture
def fault():
    from stormfield.model.errors import InputError

    return lambda match: pytest.raises(InputError, match=match)


def add(obj, source, **settings):
    from stormfield.scene.write.elements import add_element

    return add_element(obj, source, **settings)


def test_the_own_mesh_is_read_before_any_modifier(ball, read):
    ball.modifiers.new("Subdivision", "SUBSURF")
    empty = bpy.data.objects.new("Eye", None)
    bpy.context.collection.objects.link(empty)
    add(ball, empty)
    mesh, _design = read(ball)
    assert mesh.vertices.shape == (len(ball.data.vertices), 3)
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1.0, atol=1e-5)
    assert set(mesh.uv_layers) == {layer.name for layer in ball.data.uv_layers}


def test_polygons_with_many_corners_become_loop_triangles(read):
    bpy.ops.mesh.primitive_cylinder_add(vertices=12)
    obj = bpy.context.object
    bpy.ops.stormfield.add_field()
    empty = bpy.data.objects.new("Eye", None)
    bpy.context.collection.objects.link(empty)
    add(obj, empty)
    mesh, _design = read(obj)
    assert len(mesh.triangles) == 12 * 2 + 2 * 10
    uv = mesh.uv_layers["UVMap"]
    assert uv.shape == (len(mesh.triangles), 3, 2)


def test_world_parents_and_scale_end_in_the_mesh_space(ball, add_curve, read):
    ball.location, ball.scale, ball.rotation_euler = (3, -1, 2), (2, 2, 2), (0.3, 0.1, -0.7)
    curve = add_curve([(1, 0, 0), (0, 1, 0), (0, 0, 1)])
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location = (5, 5, 5)
    curve.parent, curve.location = parent, (0, 0, 1)
    add(ball, curve, type="streamline")
    bpy.context.view_layer.update()
    _mesh, design = read(ball)
    expected = ball.matrix_world.inverted() @ (curve.matrix_world @ curve.data.splines[0].points[1].co.to_3d())
    assert np.allclose(design.elements[0].points[1], expected, atol=1e-5)


@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_every_spline_becomes_an_element_in_order(ball, add_curve, read, kind):
    curve = add_curve([(1, 0, 0), (0.8, 0.5, 0), (0.2, 1, 0), (0, 1, 0)], kind=kind)
    if kind == "NURBS":
        curve.data.splines[0].use_endpoint_u = True
    curve.data.bevel_depth = 0.1  # a tube to look at is still one line
    second = curve.data.splines.new("POLY")
    second.points.add(2)
    for point, place in zip(second.points, ((0, 0, 1, 1), (0, 0.5, 0.8, 1), (0, 1, 0, 1)), strict=True):
        point.co = place
    add(ball, curve, type="singular", lam_start=0.2, lam_end=0.6)
    _mesh, design = read(ball)
    assert [element.name for element in design.elements] == ["Curve", "Curve (2)"]
    first = design.elements[0]
    assert np.allclose(first.points[0], (1, 0, 0), atol=1e-5)
    assert np.allclose(first.points[-1], (0, 1, 0), atol=1e-5)
    assert first.lam[0] == pytest.approx(0.2) and first.lam[-1] == pytest.approx(0.6)
    assert len(first.lam) == len(first.points) and list(first.lam) == sorted(first.lam)


def test_a_cyclic_curve_returns_to_its_start(ball, add_curve, read):
    circle = [(math.cos(a), math.sin(a), 0) for a in np.linspace(0, 2 * math.pi, 12, endpoint=False)]
    add(ball, add_curve(circle, cyclic=True), type="streamline")
    _mesh, design = read(ball)
    points = design.elements[0].points
    assert len(points) == 13 and points[0] == points[-1]


def test_mesh_edges_and_hair_curves_are_lines_too(ball, read):
    mesh = bpy.data.meshes.new("Wire")
    mesh.from_pydata([(0, 0, 1), (1, 0, 0), (0.7, 0, 0.7)], [(0, 2), (2, 1)], [])
    wire = bpy.data.objects.new("Wire", mesh)
    hair = bpy.data.hair_curves.new("Hair")
    hair.add_curves([2, 3])
    hair.attributes["position"].data.foreach_set("vector", np.arange(15, dtype=np.float32))
    strands = bpy.data.objects.new("Hair", hair)
    for source in (wire, strands):
        bpy.context.collection.objects.link(source)
        add(ball, source, type="streamline")
    _mesh, design = read(ball)
    assert [len(element.points) for element in design.elements] == [3, 2, 3]
    assert np.allclose(design.elements[0].points, [(0, 0, 1), (0.7, 0, 0.7), (1, 0, 0)], atol=1e-6)
    assert design.elements[2].points[-1] == (12.0, 13.0, 14.0)


def test_grease_pencil_strokes_are_lines_where_their_layer_puts_them(ball, read):
    pencils = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)
    pencil = pencils.new("Sketch")
    for name, lift in (("Drawn", 0.25), ("Hidden", 0.0)):
        layer = pencil.layers.new(name)
        layer.translation = (0.0, 0.0, lift)
        drawing = layer.frames.new(1).drawing
        drawing.add_strokes([3])
        for point, x in zip(drawing.strokes[0].points, (0.0, 0.5, 1.0), strict=True):
            point.position = (x, 0.0, 0.75)
    pencil.layers["Hidden"].hide = True
    sketch = bpy.data.objects.new("Sketch", pencil)
    bpy.context.collection.objects.link(sketch)
    add(ball, sketch, type="streamline")
    _mesh, design = read(ball)
    assert len(design.elements) == 1
    assert np.allclose(design.elements[0].points, [(0, 0, 1), (0.5, 0, 1), (1, 0, 1)], atol=1e-6)


def test_an_animated_empty_becomes_a_singularity_path(ball, read, scene):
    empty = bpy.data.objects.new("Zyklon ☂", None)
    bpy.context.collection.objects.link(empty)
    for frame, x in ((1, 1.0), (50, -1.0)):
        empty.location = (x, 0, 1)
        empty.keyframe_insert("location", frame=frame)
    for curve in __import__("stormfield.compat", fromlist=["fcurves"]).fcurves(empty):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    add(ball, empty, from_animation=True)
    scene.frame_set(17)
    _mesh, design = read(ball)
    element = design.elements[0]
    assert element.name == "Zyklon ☂"
    assert element.lam[0] == 0.0 and element.lam[-1] == pytest.approx(1.0)
    for lam, point in zip(element.lam, element.points, strict=True):
        assert point[0] == pytest.approx(1.0 - 2.0 * lam, abs=1e-5)
    assert scene.frame_current == 17


def test_lambda_that_waits_or_returns_is_told_once(ball, read):
    field = ball.stormfield
    for frame, lam in ((1, 0.0), (10, 0.5), (20, 0.5), (30, 0.2), (50, 1.0)):
        field.lam = lam
        field.keyframe_insert("lam", frame=frame)
    empty = bpy.data.objects.new("Eye", None)
    bpy.context.collection.objects.link(empty)
    add(ball, empty, from_animation=True)
    _mesh, design = read(ball)
    lams = design.elements[0].lam
    assert all(a < b for a, b in itertools.pairwise(lams))


def test_an_arrow_points_along_the_empty(ball, read):
    empty = bpy.data.objects.new("Wind", None)
    bpy.context.collection.objects.link(empty)
    empty.location, empty.rotation_euler = (0, 0, 1), (0, 0, math.pi / 2)
    add(ball, empty, type="regular")
    bpy.context.view_layer.update()
    _mesh, design = read(ball)
    assert np.allclose(design.elements[0].direction, (0, 1, 0), atol=1e-6)


def test_settings_and_the_speed_of_lambda_are_read(ball, read, scene):
    empty = bpy.data.objects.new("Eye", None)
    bpy.context.collection.objects.link(empty)
    add(ball, empty)
    scene.render.fps = 25
    ball.stormfield.solve.samples = 33
    _mesh, design = read(ball)
    assert design.settings.samples == 33
    assert design.settings.lambda_per_second == pytest.approx(25 / 49)


def test_faults_name_the_element_and_the_cure(ball, add_curve, read, fault):
    element = add(ball, None, name="Lost")
    with fault("'Lost' has no source; choose"):
        read(ball)
    element.source = ball
    with fault("'Lost' has the field's own mesh"):
        read(ball)
    element.source = add_curve([(0, 0, 1)], name="Leer")
    element.source.data.splines.clear()
    with fault("'Lost': 'Leer' has no curve yet"):
        read(ball)
    element.source = add_curve([(0, 0, 1), (1, 0, 0)])
    element.lam_start, element.lam_end = 0.7, 0.2
    with fault("ends at λ 0.2 before it starts at 0.7"):
        read(ball)
    element.lam_end, element.from_animation = 1.0, True
    bpy.ops.stormfield.remove_field()
    ball.stormfield.enabled = True
    moved = add(ball, bpy.data.objects["Curve"], from_animation=True)
    assert moved.from_animation
    with fault("λ of 'Ball' has no keyframes"):
        read(ball)


def test_elements_that_are_off_are_not_read(ball, read):
    from stormfield.model.errors import InputError

    add(ball, None, name="Lost").enabled = False
    _mesh, design = read(ball)
    with pytest.raises(InputError, match="no element"):
        design.check()
