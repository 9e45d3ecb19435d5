# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubts after a solve, and the buttons that cure them."""

import bpy
import numpy as np
import pytest
from mathutils import Vector


def kinds(obj):
    from stormfield.scene.write import doubts

    return {doubt.kind for doubt in doubts.read(obj)}


def place(obj, *places):
    bpy.context.view_layer.objects.active = obj
    for point in places:
        bpy.context.scene.cursor.location = point
        bpy.ops.stormfield.place_element(kind="vortex_ccw")
    obj.stormfield.solve.samples = 2


@pytest.fixture
def cube(native):
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.stormfield.add_field()
    obj = bpy.context.object
    place(obj, (0.2, 0.1, 1.0))
    return obj


def test_a_cube_is_too_coarse_until_it_is_subdivided_and_keeps_its_shape(cube):
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(cube) == {"coarse"}
    assert bpy.ops.stormfield.subdivide_mesh() == {"FINISHED"}
    assert kinds(cube) == set() and len(cube.data.vertices) > 1000
    places = np.array([v.co[:] for v in cube.data.vertices])
    assert np.abs(places).max(axis=1) == pytest.approx(np.ones(len(places)), abs=1e-6)
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(cube) == set()  # the cure was enough


def test_subdividing_keeps_uvs_groups_and_shape_keys(cube):
    cube.vertex_groups.new(name="top").add([v.index for v in cube.data.vertices if v.co.z > 0], 1.0, "ADD")
    cube.shape_key_add(name="Basis")
    cube.shape_key_add(name="High").data[0].co.z += 2.0
    assert bpy.ops.stormfield.subdivide_mesh(times=1) == {"FINISHED"}
    assert len(cube.data.uv_layers) == 1 and len(cube.vertex_groups) == 1
    high = cube.data.shape_keys.key_blocks["High"].data
    assert len(high) == len(cube.data.vertices) == 26
    moved = sum(
        (a.co - b.co).length > 0.5 for a, b in zip(high, cube.data.shape_keys.key_blocks["Basis"].data, strict=True)
    )
    assert moved > 3


def test_what_is_too_much_is_refused_with_the_cure(cube):
    with pytest.raises(RuntimeError, match="less often"):
        bpy.ops.stormfield.subdivide_mesh(times=10)
    cube.modifiers.new("Multires", "MULTIRES")
    with pytest.raises(RuntimeError, match="Multiresolution"):
        bpy.ops.stormfield.subdivide_mesh(times=1)


@pytest.fixture
def two_balls(native):
    for x in (0.0, 4.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, location=(x, 0.0, 0.0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.join()
    bpy.ops.object.transform_apply()
    bpy.ops.stormfield.add_field()
    obj = bpy.context.object
    place(obj, (0.0, 0.0, 1.0))
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(obj) == {"no_element"}
    return obj


def test_a_part_without_element_is_filled(two_balls, attribute):
    assert bpy.ops.stormfield.fill_parts() == {"FINISHED"}
    arrow = two_balls.stormfield.elements[-1].source
    bpy.context.view_layer.update()
    assert (arrow.matrix_world.translation - Vector((4.0, -1.0, 0.0))).length < 0.1
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(two_balls) == set()
    vectors = attribute(two_balls, "sf_advection")
    assert np.abs(vectors).max(axis=1).min() >= 0.0 and (np.abs(vectors).max(axis=1) > 0).mean() > 0.95


def test_a_part_without_element_is_left_out_until_there_is_another(two_balls):
    assert bpy.ops.stormfield.leave_out_parts() == {"FINISHED"}
    assert kinds(two_balls) == set()
    bpy.ops.stormfield.solve()
    assert kinds(two_balls) == set()
    two_balls.stormfield.left_out = 2
    assert kinds(two_balls) == {"no_element"}


def test_normals_inward_are_said_and_fixed(ball, native):
    ball.data.flip_normals()
    place(ball, (0.0, 0.0, 1.0))
    ball.stormfield.elements[0].radius = 0.5
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(ball) == {"inward"}
    assert bpy.ops.stormfield.fix_normals() == {"FINISHED"}
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert kinds(ball) == set()
    assert all(face.normal.dot(face.center) > 0 for face in ball.data.polygons)


def test_undo_brings_doubts_back_with_the_field(cube):
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.subdivide_mesh(times=1)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert kinds(bpy.context.object) == {"coarse"}


def test_a_radius_below_the_edges_is_said_before_solving(ball):
    from stormfield.scene.write.elements import add_element
    from stormfield.session import coarse_mesh

    edge = coarse_mesh.mean_edge(ball.data)
    assert edge == pytest.approx(0.15, abs=0.01)
    empty = bpy.data.objects.new("Eye", None)
    bpy.context.scene.collection.objects.link(empty)
    element = add_element(ball, empty, type="singular", radius=0.5 * edge)
    said = coarse_mesh.why_too_coarse(ball)
    assert "'Eye'" in said and "Subdivide" in said and f"{edge:.2g}" in said
    ball.stormfield.solve.solve_on, ball.stormfield.solve.edge = "DENSITY", 0.4 * edge
    assert coarse_mesh.why_too_coarse(ball) == ""
    ball.stormfield.solve.solve_on = "MESH"
    bpy.ops.stormfield.subdivide_mesh(times=2)
    assert coarse_mesh.why_too_coarse(ball) == ""
    element.enabled = False
    element.radius = 1e-4
    assert coarse_mesh.why_too_coarse(ball) == ""


def test_a_density_is_chosen_for_the_smallest_storm_that_the_mesh_can_show(ball):
    from stormfield.scene.write.elements import add_element
    from stormfield.session import coarse_mesh

    edge = coarse_mesh.mean_edge(ball.data)
    empty = bpy.data.objects.new("Eye", None)
    empty.location = (0.0, 0.0, 1.0)
    bpy.context.scene.collection.objects.link(empty)
    element = add_element(ball, empty, type="singular", kind="vortex_ccw", radius=1.5 * edge)
    ball.stormfield.solve.samples = 2
    bpy.ops.stormfield.solve()
    assert kinds(ball) == {"coarse"}
    count = len(ball.data.vertices)
    assert bpy.ops.stormfield.solve_on_density() == {"FINISHED"}
    solve = ball.stormfield.solve
    assert (solve.solve_on, solve.edge) == ("DENSITY", pytest.approx(0.5 * edge, rel=1e-5))
    assert len(ball.data.vertices) == count
    bpy.ops.stormfield.solve()
    assert kinds(ball) == set()
    element.radius = 0.9 * edge  # no vertex of the mesh could show it
    assert not bpy.ops.stormfield.solve_on_density.poll()
    bpy.ops.stormfield.solve()
    assert kinds(ball) == {"coarse"}
