# SPDX-License-Identifier: GPL-3.0-or-later
"""Solve takes meshes as artists have them, and says in one line what of them is no surface."""

import bmesh
import bpy
import numpy as np
import pytest


@pytest.fixture
def plane(scene):
    """A grid of 20 × 20 in XY from -1 to 1 with a left vortex in its middle."""
    from stormfield.scene.write.elements import add_element

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=2)
    obj = bpy.context.object
    bpy.ops.stormfield.add_field()
    empty = bpy.data.objects.new("Eye", None)
    scene.collection.objects.link(empty)
    add_element(obj, empty, type="singular", kind="vortex_ccw", radius=0.4)
    obj.stormfield.solve.samples = 2
    return obj


def edited(obj, change):
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    mesh.verts.ensure_lookup_table()
    mesh.faces.ensure_lookup_table()
    change(mesh)
    mesh.to_mesh(obj.data)
    mesh.free()
    obj.data.update()


def vertex_at(mesh, x, y):
    return min(mesh.verts, key=lambda vertex: (vertex.co.x - x) ** 2 + (vertex.co.y - y) ** 2)


def split_faces(mesh):
    bmesh.ops.split_edges(mesh, edges=mesh.edges)


def fin(mesh):
    row = sorted((v for v in mesh.verts if abs(v.co.x - 0.5) < 1e-4), key=lambda v: v.co.y)
    top = [mesh.verts.new(v.co + type(v.co)((0, 0, 0.5))) for v in row]
    for k in range(len(row) - 1):
        mesh.faces.new((row[k], row[k + 1], top[k + 1], top[k]))


def bow_tie(mesh):
    corner = vertex_at(mesh, 1, 1)
    more = [mesh.verts.new((x, y, 0)) for x, y in ((1.5, 1), (1.5, 1.5), (1, 1.5))]
    mesh.faces.new((corner, *more))


def no_area(mesh):
    a, b = vertex_at(mesh, 0.5, 0.5), vertex_at(mesh, 0.6, 0.5)
    middle = mesh.verts.new((a.co + b.co) / 2)
    mesh.faces.new((a, b, middle))


def side_vertex(mesh):
    """A vertex on an edge of two quads, which become pentagons with a straight corner."""
    edge = next(edge for edge in mesh.edges if len(edge.link_faces) == 2)
    bmesh.utils.edge_split(edge, edge.verts[0], 0.5)


def repeated(mesh):
    face = mesh.faces[5]
    mesh.faces.new(tuple(reversed(list(face.verts)))[1:])


FAULTS = [
    (split_faces, "joined 1159 vertices of seams"),
    (fin, "of edges with more than two faces"),
    (bow_tie, "1 vertex where parts touch in a point"),
    (no_area, "without area"),
    (side_vertex, ""),
    (repeated, ""),
]


def turn(obj):
    """Circulation over speed around the origin, at vertices near it: 1 turns left."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flow = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.attributes["sf_advection"].data.foreach_get("vector", flow)
    flow = flow.reshape(-1, 3)
    points = np.array([vertex.co for vertex in mesh.vertices])
    near = (np.linalg.norm(points, axis=1) < 0.3) & (np.hypot(*points[:, :2].T) > 0.02)
    left = np.cross((0, 0, 1), points[near])
    return (np.einsum("ij,ij->i", left, flow[near]) / np.linalg.norm(left, axis=1)
            / np.linalg.norm(flow[near], axis=1)).min()  # fmt: skip


def told(obj):
    """What the Solve panel says of the result, besides that the mesh is coarse."""
    from stormfield.scene.write import doubts

    return [doubt.text for doubt in doubts.read(obj) if doubt.kind != "coarse"]


@pytest.mark.parametrize(("fault", "said"), FAULTS)
def test_the_field_is_solved_around_what_is_no_surface(plane, fault, said):
    edited(plane, fault)
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert turn(plane) > 0.98
    assert len(told(plane)) <= 1
    assert said in "".join(told(plane))


@pytest.mark.parametrize("fault", [fault for fault, _said in FAULTS])
def test_all_targets_are_baked_on_such_a_mesh(plane, scene, fault):
    edited(plane, fault)
    scene.frame_end = 2
    plane.data.uv_layers.new()
    plane.stormfield.bake.use_exr = plane.stormfield.bake.use_vdb = True
    plane.stormfield.bake.resolution = "256"
    bpy.ops.stormfield.solve()
    assert bpy.ops.stormfield.bake() == {"FINISHED"}


def test_an_inner_wall_is_solved_around(scene):
    from stormfield.scene.write.elements import add_element

    bpy.ops.mesh.primitive_cube_add(size=2)
    obj = bpy.context.object
    edited(obj, lambda mesh: bmesh.ops.subdivide_edges(mesh, edges=mesh.edges, cuts=9, use_grid_fill=True))
    edited(obj, lambda mesh: mesh.faces.new(sorted(
        (v for v in mesh.verts if abs(v.co.x) < 1e-4), key=lambda v: np.arctan2(v.co.z, v.co.y))))  # fmt: skip
    bpy.ops.stormfield.add_field()
    empty = bpy.data.objects.new("Eye", None)
    scene.collection.objects.link(empty)
    empty.location = (0.5, 0, 1)
    add_element(obj, empty, type="singular", kind="vortex_ccw", radius=0.5)
    obj.stormfield.solve.samples = 2
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert any("edges with more than two faces" in text for text in told(obj))


def test_parts_without_element_are_told_in_one_sentence(plane):
    edited(plane, split_faces)
    plane.stormfield.solve.weld = 0.0
    bpy.ops.stormfield.solve()
    assert [text for text in told(plane) if "parts of the mesh have no element" in text]
    assert len(told(plane)) == 1


def test_flipped_normals_turn_left_seen_from_outside_and_are_told(ball, scene, attribute):
    from stormfield.scene.write.elements import add_element

    ball.data.flip_normals()
    empty = bpy.data.objects.new("Eye", None)
    scene.collection.objects.link(empty)
    empty.location = (0, 0, 1)
    add_element(ball, empty, type="singular", kind="vortex_ccw", radius=0.4)
    ball.stormfield.solve.samples = 2
    bpy.ops.stormfield.solve()
    points = np.array([vertex.co for vertex in ball.data.vertices])
    near = (points[:, 2] > 0.9) & (points[:, 2] < 0.999)
    left = np.cross((0, 0, 1), points[near])
    assert (np.einsum("ij,ij->i", left, attribute(ball, "sf_advection")[near]) > 0).all()
    assert any("point inward" in text for text in told(ball))
    bpy.ops.stormfield.fix_normals()
    bpy.ops.stormfield.solve()
    assert told(ball) == []
    assert (np.einsum("ij,ij->i", left, attribute(ball, "sf_advection")[near]) > 0).all()


@pytest.mark.parametrize(("fault", "said"), FAULTS)
def test_faults_are_selected_in_edit_mode(plane, fault, said):
    from stormfield.model.manifold import manifold
    from stormfield.scene.read.mesh import read_mesh

    edited(plane, fault)
    bpy.ops.stormfield.select_faults()
    if manifold(read_mesh(plane), 1e-5).same:
        assert plane.mode == "OBJECT"
        return
    assert plane.mode == "EDIT"
    chosen = [v for v in bmesh.from_edit_mesh(plane.data).verts if v.select]
    assert len(chosen) > 0
    if fault in (bow_tie, fin):
        assert len(chosen) == (1 if fault is bow_tie else 21)


def test_a_clean_mesh_has_no_remarks(plane):
    bpy.ops.stormfield.solve()
    assert told(plane) == []
    assert bpy.ops.stormfield.select_faults() == {"FINISHED"}
    assert plane.mode == "OBJECT"


def test_a_profile_whose_faces_a_modifier_makes_names_the_cure(scene):
    mesh = bpy.data.meshes.new("Profile")
    mesh.from_pydata([(1, 0, 0), (1, 0, 1)], [(0, 1)], [])
    obj = bpy.data.objects.new("Profile", mesh)
    scene.collection.objects.link(obj)
    obj.modifiers.new("Screw", "SCREW")
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="made by its modifiers; make them its own: Object, Convert, Mesh"):
        bpy.ops.stormfield.add_field()


@pytest.mark.parametrize("fault", [fault for fault, _said in FAULTS])
def test_such_a_mesh_is_analyzed(plane, scene, fault):
    edited(plane, fault)
    scene.frame_end = 4
    plane.stormfield.solve.samples = 3
    bpy.ops.stormfield.solve()
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}
    middle = [e for e in plane.stormfield.analysis.ecg.items if np.linalg.norm(e.position) < 0.1]
    assert [entity.kind for entity in middle] == ["center"] or middle[0].kind in {"source", "sink"}
    assert bpy.ops.stormfield.analyze_lambda() == {"FINISHED"}
    assert bpy.ops.stormfield.streamlines() == {"FINISHED"}
    assert bpy.ops.stormfield.pathlines(count=5) == {"FINISHED"}
    assert bpy.ops.stormfield.morse_sets() == {"FINISHED"}
    sets = [value.value for value in plane.data.attributes["sf_morse"].data]
    assert len(sets) == len(plane.data.polygons)
    near = min(plane.data.polygons, key=lambda polygon: polygon.center.length).index
    assert sets[near] >= 0


def test_a_coarse_cage_is_solved_at_a_density(scene):
    from stormfield.scene.write.elements import add_element

    bpy.ops.mesh.primitive_cube_add(size=2)
    cage = bpy.context.object
    cage.modifiers.new("Subdivision", "SUBSURF").levels = 4
    bpy.ops.stormfield.add_field()
    empty = bpy.data.objects.new("Eye", None)
    scene.collection.objects.link(empty)
    mesh = cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    empty.location = (0, 0, max(vertex.co.z for vertex in mesh.vertices))
    add_element(cage, empty, type="singular", kind="vortex_ccw", radius=0.5)
    settings = cage.stormfield.solve
    settings.samples, settings.solve_on, settings.edge = 2, "DENSITY", 0.2
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    mesh = cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flow = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.attributes["sf_advection"].data.foreach_get("vector", flow)
    flow = flow.reshape(-1, 3)
    points = np.array([vertex.co for vertex in mesh.vertices])
    around = (points[:, 2] > 0) & (np.abs(np.hypot(points[:, 0], points[:, 1]) - 0.3) < 0.05)
    left = np.cross((0, 0, 1), points[around])
    turn = np.einsum("ij,ij->i", left, flow[around])
    assert (turn / np.linalg.norm(left, axis=1) / np.linalg.norm(flow[around], axis=1)).min() > 0.95
