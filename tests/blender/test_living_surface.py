# SPDX-License-Identifier: GPL-3.0-or-later
"""A field on a surface that armatures, shape keys and other modifiers move: it lies on the surface that is seen, and
turns with it, without Python."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector


@pytest.fixture
def tube(scene, add_curve):
    """A tube of radius 0.3 along Z from 0 to 4, its flow along the axis."""
    from stormfield.scene.write.elements import add_element

    obj = bpy.data.objects.new("Tube", rings(40))
    scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.stormfield.add_field()
    for x in (0.3, -0.3):
        curve = add_curve([(x, 0, z) for z in np.linspace(0.2, 3.8, 12)], name=f"Stream {x}")
        add_element(obj, curve, type="streamline", radius=0.2)
    obj.stormfield.solve.samples = 2
    bpy.context.view_layer.objects.active = obj
    return obj


def rings(count):
    """The side of a cylinder along Z."""
    corners, height = 32, 4.0
    points = [
        (0.3 * math.cos(2 * math.pi * k / corners), 0.3 * math.sin(2 * math.pi * k / corners), height * ring / count)
        for ring in range(count + 1)
        for k in range(corners)
    ]
    faces = [
        (ring * corners + k, ring * corners + (k + 1) % corners, (ring + 1) * corners + (k + 1) % corners,
         (ring + 1) * corners + k)
        for ring in range(count) for k in range(corners)
    ]  # fmt: skip
    mesh = bpy.data.meshes.new("Tube")
    mesh.from_pydata(points, [], faces)
    return mesh


def bend(obj, degrees):
    modifier = obj.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis, modifier.angle = "BEND", "X", math.radians(degrees)
    return modifier


def evaluated(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def vectors(mesh, name="sf_advection"):
    values = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.attributes[name].data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def off_tangent(mesh):
    """|v·n| / |v|, the largest."""
    normals = np.array([normal.vector for normal in mesh.vertex_normals])
    flow = vectors(mesh)
    speed = np.linalg.norm(flow, axis=1)
    moving = speed > 1e-3 * speed.max()
    return np.abs(np.einsum("ij,ij->i", normals, flow)[moving] / speed[moving]).max()


def axis_cosine(mesh):
    """Mean cosine between the flow and the direction from each ring of the tube to the next."""
    points = np.array([vertex.co for vertex in mesh.vertices]).reshape(41, 32, 3)
    axis = np.gradient(points, axis=0)[5:-5]
    flow = vectors(mesh).reshape(41, 32, 3)[5:-5]
    product = np.einsum("rkj,rkj->rk", axis, flow)
    return (product / np.linalg.norm(axis, axis=-1) / np.linalg.norm(flow, axis=-1)).mean()


def armature(obj, _scene):
    bones = bpy.data.armatures.new("Bones")
    rig = bpy.data.objects.new("Rig", bones)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    parent = None
    for number in range(4):
        bone = bones.edit_bones.new(f"Bone {number}")
        bone.head, bone.tail, bone.parent = (0, 0, number), (0, 0, number + 1), parent
        parent = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    for number in range(4):
        group = obj.vertex_groups.new(name=f"Bone {number}")
        for vertex in obj.data.vertices:
            weight = max(0.0, 1.0 - abs(vertex.co.z - number - 0.5))
            group.add([vertex.index], weight, "REPLACE")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    for pose in rig.pose.bones[1:]:
        pose.rotation_mode = "XYZ"
        pose.rotation_euler.x = math.radians(27)
    bpy.context.view_layer.objects.active = obj


def shape_key(obj, _scene):
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Bent")
    for vertex, point in zip(obj.data.vertices, key.data, strict=True):
        angle = vertex.co.z * 0.4
        point.co.x, point.co.z = (vertex.co.x + 2) * math.cos(angle) - 2, (vertex.co.x + 2) * math.sin(angle)
    key.value = 1.0


def lattice(obj, scene):
    data = bpy.data.lattices.new("Lattice")
    cage = bpy.data.objects.new("Lattice", data)
    scene.collection.objects.link(cage)
    data.points_w = 3
    cage.location, cage.scale = (0, 0, 2), (1, 1, 4)
    for point in data.points[4:8]:
        point.co_deform.x += 0.8
    obj.modifiers.new("Lattice", "LATTICE").object = cage


DEFORMERS = [lambda obj, scene: bend(obj, 80), armature, shape_key, lattice]


@pytest.mark.parametrize("deform", DEFORMERS)
@pytest.mark.parametrize("when", ["before", "after"])
def test_the_flow_lies_on_the_surface_that_is_seen(tube, scene, deform, when):
    if when == "before":
        deform(tube, scene)
    bpy.ops.stormfield.solve()
    if when == "after":
        deform(tube, scene)
    mesh = evaluated(tube)
    rest = np.array([vertex.co for vertex in tube.data.vertices])
    assert np.abs(np.array([vertex.co for vertex in mesh.vertices]) - rest).max() > 0.1
    assert off_tangent(mesh) < 1e-3
    assert axis_cosine(mesh) > 0.98


@pytest.mark.parametrize("when", ["before", "after"])
def test_the_flow_lies_on_cloth_at_every_baked_frame(tube, scene, when):
    if when == "before":
        cloth(tube, scene)
    bpy.ops.stormfield.solve()
    if when == "after":
        cloth(tube, scene)
    rest = np.array([vertex.co for vertex in tube.data.vertices])
    moved = []
    for frame in (4, 8, 12):
        scene.frame_set(frame)
        mesh = evaluated(tube)
        points = np.array([vertex.co for vertex in mesh.vertices])
        moved.append(np.abs(points - rest).max())
        assert off_tangent(mesh) < 1e-3
        assert axis_cosine(mesh) > 0.99
    assert moved == sorted(moved) and moved[-1] > 0.1


def cloth(obj, scene):
    """A tube whose lower end is held, and that falls sideways; twelve frames of it are baked."""
    scene.gravity = (-9.81, 0.0, 0.0)
    held = obj.vertex_groups.new(name="Held")
    held.add([vertex.index for vertex in obj.data.vertices if vertex.co.z < 0.5], 1.0, "REPLACE")
    modifier = obj.modifiers.new("Cloth", "CLOTH")
    modifier.settings.vertex_group_mass = "Held"
    modifier.point_cache.frame_start, modifier.point_cache.frame_end = 1, 12
    bpy.context.view_layer.update()
    with bpy.context.temp_override(scene=scene, active_object=obj, object=obj, point_cache=modifier.point_cache):
        bpy.ops.ptcache.bake(bake=True)
    assert modifier.point_cache.is_baked


def test_at_rest_nothing_turns(tube):
    bpy.ops.stormfield.solve()
    before = vectors(evaluated(tube)).copy()
    bend(tube, 0)
    after = vectors(evaluated(tube))
    assert "Stormfield Turn" in tube.modifiers
    assert np.abs(after - before).max() < 0.02 * np.abs(before).max()


def test_speed_keeps_the_meaning_that_is_chosen(tube):
    bpy.ops.stormfield.solve()
    speed = np.linalg.norm(vectors(evaluated(tube)), axis=1)
    tube.shape_key_add(name="Basis")
    key = tube.shape_key_add(name="Long")
    for point in key.data:
        point.co.z *= 1.5
    key.value = 1.0

    def ratio():
        mesh = evaluated(tube)
        flow = np.linalg.norm(vectors(mesh), axis=1)
        stored = np.empty(len(mesh.vertices), np.float32)
        mesh.attributes["sf_speed"].data.foreach_get("value", stored)
        assert np.allclose(stored, flow, atol=1e-5)
        middle = slice(32 * 15, 32 * 25)
        return (flow[middle] / speed[middle]).mean()

    assert ratio() == pytest.approx(1.5, rel=1e-3)
    tube.stormfield.speed_on = "WORLD"
    assert ratio() == pytest.approx(1.0, rel=1e-3)


@pytest.fixture
def arrow(scene):
    """A flat square in XY whose flow runs along X."""
    from stormfield.scene.write.elements import add_element

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=2)
    obj = bpy.context.object
    bpy.ops.stormfield.add_field()
    empty = bpy.data.objects.new("Wind", None)
    scene.collection.objects.link(empty)
    add_element(obj, empty, type="regular", radius=0.5)
    obj.stormfield.solve.samples = 2
    bpy.ops.stormfield.solve()
    return obj


def test_a_wave_tilts_the_flow(arrow, scene):
    wave = arrow.modifiers.new("Wave", "WAVE")
    wave.height, wave.width, wave.narrowness = 0.3, 1.0, 2.0
    for frame in (10, 25):
        scene.frame_set(frame)
        mesh = evaluated(arrow)
        assert np.ptp([vertex.co.z for vertex in mesh.vertices]) > 0.05
        assert off_tangent(mesh) < 1e-3


def test_turned_copies_of_an_array_turn_their_flow(arrow, scene):
    turn = bpy.data.objects.new("Turn", None)
    scene.collection.objects.link(turn)
    turn.location, turn.rotation_euler = (0, 0, 1), (0.4, 0.3, math.radians(70))
    array = arrow.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_object_offset, array.offset_object = 3, False, True, turn
    bpy.context.view_layer.update()
    mesh = evaluated(arrow)
    flow = vectors(mesh).reshape(3, -1, 3)
    matrix = np.array(turn.matrix_world)[:3, :3]
    assert np.allclose(flow[1], flow[0] @ matrix.T, atol=1e-4)
    assert np.allclose(flow[2], flow[0] @ matrix.T @ matrix.T, atol=1e-4)
    assert off_tangent(mesh) < 1e-3


def test_a_mirror_mirrors_the_flow(arrow):
    for vertex in arrow.data.vertices:
        vertex.co.x += 1.5
    bpy.ops.stormfield.solve()
    arrow.modifiers.new("Mirror", "MIRROR")
    flow = vectors(evaluated(arrow)).reshape(2, -1, 3)
    assert np.allclose(flow[1], flow[0] * (-1, 1, 1), atol=1e-5)


def test_a_subdivided_cage_carries_a_tangent_flow(storms):
    storms.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.ops.stormfield.solve()
    assert off_tangent(evaluated(storms)) < 1e-3


def test_faces_that_modifiers_add_do_not_break_the_flow(storms):
    for kind in ("SOLIDIFY", "BEVEL", "TRIANGULATE"):
        storms.modifiers.new(kind, kind)
    bpy.ops.stormfield.solve()
    mesh = evaluated(storms)
    assert np.isfinite(vectors(mesh)).all()
    assert off_tangent(mesh) < 1e-3


def test_the_flow_turns_without_the_addon(tube, scene, tmp_path):
    bend(tube, 80)
    bpy.ops.stormfield.solve()
    path = str(tmp_path / "bent.blend")
    name = tube.name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    import stormfield

    stormfield.unregister()
    try:
        bpy.ops.wm.open_mainfile(filepath=path)
        mesh = evaluated(bpy.data.objects[name])
        assert off_tangent(mesh) < 1e-3 and axis_cosine(mesh) > 0.98
    finally:
        stormfield.register()


def test_an_analysis_reads_the_mesh_at_rest(tube):
    from stormfield.scene.read.current_field import read_current

    bpy.ops.stormfield.solve()
    before = read_current(bpy.context, tube).values
    bend(tube, 80)
    evaluated(tube)
    assert np.allclose(read_current(bpy.context, tube).values, before, atol=1e-6)


def test_remove_field_takes_the_turning_away(tube):
    bend(tube, 80)
    bpy.ops.stormfield.solve()
    assert "Stormfield Turn" in tube.modifiers
    bpy.ops.stormfield.remove_field()
    assert [modifier.name for modifier in tube.modifiers] == ["Bend"]


def seen_point(obj, vertex):
    """Where a vertex of the own mesh is seen, in the world."""
    return obj.matrix_world @ evaluated(obj).vertices[vertex].co


def read(obj):
    from stormfield.scene.read.design import read_design

    return read_design(bpy.context, obj)[1].elements


@pytest.mark.parametrize("deform", DEFORMERS)
def test_what_is_placed_on_the_seen_surface_lands_on_the_same_place_at_rest(tube, scene, deform, add_curve):
    from stormfield.scene.write.elements import add_element

    deform(tube, scene)
    tube.stormfield.elements.clear()
    vertices = [32 * ring + 5 for ring in range(18, 30)]
    empty = bpy.data.objects.new("Eye", None)
    scene.collection.objects.link(empty)
    empty.location = seen_point(tube, vertices[0])
    add_element(tube, empty, type="singular", radius=0.1)
    line = add_curve([seen_point(tube, vertex) for vertex in vertices], name="Line")
    add_element(tube, line, type="streamline", radius=0.1)
    bpy.context.view_layer.update()
    eye, stream = read(tube)
    rest = np.array([tube.data.vertices[vertex].co for vertex in vertices])
    assert np.allclose(eye.points[0], rest[0], atol=1e-4)
    assert np.allclose(stream.points, rest, atol=1e-4)


def test_place_at_cursor_on_a_posed_mesh_solves_there(tube, scene):
    bend(tube, 80)
    tube.stormfield.elements.clear()
    vertex = 32 * 30 + 7
    scene.cursor.location = seen_point(tube, vertex)
    bpy.ops.stormfield.place_element(kind="vortex_ccw")
    assert np.allclose(read(tube)[0].points[0], tube.data.vertices[vertex].co, atol=1e-4)
    assert bpy.ops.stormfield.solve() == {"FINISHED"}


def test_an_arrow_turns_back_with_the_surface(tube, scene):
    from stormfield.scene.write.elements import add_element

    bend(tube, 80)
    tube.stormfield.elements.clear()
    low, high = 32 * 30 + 7, 32 * 31 + 7
    along = (seen_point(tube, high) - seen_point(tube, low)).normalized()
    empty = bpy.data.objects.new("Wind", None)
    scene.collection.objects.link(empty)
    empty.location, empty.rotation_mode = seen_point(tube, low), "QUATERNION"
    empty.rotation_quaternion = along.to_track_quat("X", "Z")
    add_element(tube, empty, type="regular", radius=0.1)
    bpy.context.view_layer.update()
    assert np.allclose(read(tube)[0].direction, (0, 0, 1), atol=0.04)  # a ring turns by 0.035


def test_what_was_placed_at_rest_stays_when_the_mesh_is_posed(tube):
    before = [element.points for element in read(tube)]
    bend(tube, 80)
    bpy.context.view_layer.update()
    for old, new in zip(before, read(tube), strict=True):
        assert np.allclose(old, new.points, atol=1e-6)


def test_a_curve_on_a_subdivided_cage_is_carried_to_the_cage(scene, add_curve):
    from stormfield.scene.write.elements import add_element

    bpy.ops.mesh.primitive_cube_add(size=2)
    cage = bpy.context.object
    cage.modifiers.new("Subdivision", "SUBSURF").levels = 4
    bpy.ops.stormfield.add_field()
    cage.stormfield.solve.samples = 2
    mesh = evaluated(cage)
    top = [vertex.co.copy() for vertex in mesh.vertices if abs(vertex.co.y) < 1e-4 and vertex.co.z > 0.3]
    top.sort(key=lambda place: place.x)
    add_element(cage, add_curve(top), type="streamline", radius=0.3)
    bpy.context.view_layer.update()
    before = len(bpy.data.objects), len(bpy.data.scenes)
    points = np.array(read(cage)[0].points)
    assert np.abs(np.abs(points).max(axis=1) - 1.0).max() < 1e-4  # on the cube
    assert (len(bpy.data.objects), len(bpy.data.scenes)) == before
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert off_tangent(evaluated(cage)) < 1e-3


def test_a_source_on_a_copy_of_an_array_acts_on_the_mesh_itself(arrow, scene):
    array = arrow.modifiers.new("Array", "ARRAY")
    array.count = 2
    bpy.context.view_layer.update()
    source = arrow.stormfield.elements[0].source
    source.location = (2.25, 0.5, 0.0)
    bpy.context.view_layer.update()
    assert np.allclose(read(arrow)[0].points[0], (0.25, 0.5, 0.0), atol=1e-5)


@pytest.mark.parametrize("x", [1.5, -1.5])
def test_left_turns_left_on_the_half_of_a_mirror_where_it_lies(arrow, scene, x):
    for vertex in arrow.data.vertices:
        vertex.co.x += 1.5
    arrow.modifiers.new("Mirror", "MIRROR")
    element = arrow.stormfield.elements[0]
    element.type, element.kind = "singular", "vortex_ccw"
    element.source.location = (x, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert np.allclose(read(arrow)[0].points[0], (1.5, 0.0, 0.0), atol=1e-5)
    bpy.ops.stormfield.solve()
    mesh = evaluated(arrow)
    points, flow = np.array([vertex.co for vertex in mesh.vertices]), vectors(mesh)
    away = points - (x, 0.0, 0.0)
    near = (np.linalg.norm(away, axis=1) < 0.5) & (np.linalg.norm(away, axis=1) > 0.05)
    assert (np.cross(away[near], flow[near])[:, 2] > 0).all()


def lines_on(obj):
    """Curves along the tube, through vertices and through the middles of faces; with the own vertices around each."""
    from stormfield.scene.write.curve_objects import make_curves

    columns = [[32 * ring + side for ring in range(2, 38)] for side in (0, 9, 20)]
    rest = np.array([vertex.co for vertex in obj.data.vertices])
    through = [rest[column] for column in columns]
    between = [(rest[column] + rest[np.array(column) + 33]) / 2 for column in columns]
    made = make_curves("Lines", [*through, *between], parent=obj)
    return made, columns


def points_of(made):
    data = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.empty(len(data.points) * 3, np.float32)
    data.attributes["position"].data.foreach_get("vector", places)
    return places.reshape(2, 3, -1, 3)


def off_lines(obj, made, columns):
    """The largest distance of the curves to where their places are seen, the middles of faces to the surface."""
    mesh = evaluated(obj)
    seen = np.array([vertex.co for vertex in mesh.vertices])[: len(obj.data.vertices)]
    through, between = points_of(made)
    worst = np.abs(through - seen[np.array(columns)]).max()
    found = [
        obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).closest_point_on_mesh(p)
        for p in between.reshape(-1, 3)
    ]
    return max(
        worst,
        max((place - Vector(p)).length for (_, place, *_), p in zip(found, between.reshape(-1, 3), strict=True)),
    )


@pytest.mark.parametrize("deform", DEFORMERS)
@pytest.mark.parametrize("when", ["before", "after"])
def test_curves_of_an_analysis_lie_on_the_surface_that_is_seen(tube, scene, deform, when):
    bpy.ops.stormfield.solve()
    if when == "before":
        deform(tube, scene)
    made, columns = lines_on(tube)
    if when == "after":
        deform(tube, scene)
        bpy.context.view_layer.update()
    assert off_lines(tube, made, columns) < 1e-3
    assert (
        np.abs(
            points_of(made)[0] - np.array([tube.data.vertices[v].co for v in np.ravel(columns)]).reshape(3, -1, 3)
        ).max()
        > 0.1
    )


def test_streamlines_lie_on_the_surface_that_is_seen(tube):
    bend(tube, 80)
    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.streamlines()
    made = next(obj for obj in tube.children if obj.type == "CURVES")
    data = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.empty(len(data.points) * 3, np.float32)
    data.attributes["position"].data.foreach_get("vector", places)
    places = places.reshape(-1, 3)
    seen = tube.evaluated_get(bpy.context.evaluated_depsgraph_get())
    off = [(seen.closest_point_on_mesh(Vector(place))[1] - Vector(place)).length for place in places]
    assert max(off) < 1e-3


def test_curves_stay_on_the_half_that_they_were_made_on(arrow):
    from stormfield.scene.write.curve_objects import make_curves

    mirror = arrow.modifiers.new("Mirror", "MIRROR")
    mirror.use_axis = (True, False, False)
    bpy.ops.stormfield.solve()
    rest = np.array([vertex.co for vertex in arrow.data.vertices])
    made = make_curves("Lines", [rest[:40]], parent=arrow)
    data = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.empty(len(data.points) * 3, np.float32)
    data.attributes["position"].data.foreach_get("vector", places)
    assert np.abs(places.reshape(-1, 3) - rest[:40]).max() < 1e-5


def test_curves_on_a_mesh_that_nothing_changes_have_no_modifier(tube):
    bpy.ops.stormfield.solve()
    made, _columns = lines_on(tube)
    assert not made.modifiers


def test_fixed_points_lie_on_the_surface_that_is_seen(tube):
    from stormfield.scene.write.analysis_objects import _points

    bend(tube, 80)
    bpy.ops.stormfield.solve()
    rest = np.array([vertex.co for vertex in tube.data.vertices])[100:200]
    _points(tube, bpy.context.scene.collection, "Entities", rest, {})
    (made,) = [obj for obj in tube.children if obj.type == "MESH"]
    made.hide_set(False)
    seen = np.array([vertex.co for vertex in evaluated(tube).vertices])[100:200]
    assert np.abs(np.array([vertex.co for vertex in evaluated(made).vertices]) - seen).max() < 1e-4
