# SPDX-License-Identifier: GPL-3.0-or-later
"""Field from Attribute: vectors of points, faces and corners, still or over frames, and what is refused."""

import bpy
import numpy as np
import pytest
from stormfield.scene.read.attached import LAMBDA

AXIS = np.array([0.3, -0.5, 0.8])


@pytest.fixture
def plain():
    """A sphere without a field, active."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0)
    return bpy.context.object


def points_of(mesh):
    values = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(float)


def along(obj, vectors):
    """The share of vectors at the vertices that is along the surface, by the core's own tangent planes."""
    from stormfield import native
    from stormfield.scene.read.mesh import read_mesh

    mesh = read_mesh(obj)
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    return native.VectorField.from_space(surface, vectors).to_space()


def put(mesh, name, vectors, domain="POINT"):
    attribute = mesh.attributes.new(name, "FLOAT_VECTOR", domain)
    attribute.data.foreach_set("vector", np.asarray(vectors, np.float32).ravel())


def shown(obj, name="sf_advection"):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = np.empty(len(evaluated.vertices) * 3, np.float32)
    evaluated.attributes[name].data.foreach_get("vector", values)
    return values.reshape(-1, 3).astype(float)


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
@pytest.mark.parametrize("across", [0.0, 0.7])
def test_an_attribute_becomes_the_field(native, plain, domain, across):
    """A rotation, with a share across the surface that is left out."""
    places = points_of(plain.data)
    if domain == "FACE":
        places = np.array([polygon.center for polygon in plain.data.polygons])
    elif domain == "CORNER":
        places = places[[loop.vertex_index for loop in plain.data.loops]]
    put(plain.data, "velocity", np.cross(AXIS, places) + across * places, domain)
    assert bpy.ops.stormfield.field_from_attribute(attribute="velocity") == {"FINISHED"}
    assert plain.stormfield.enabled and LAMBDA in plain.modifiers
    exact = along(plain, np.cross(AXIS, points_of(plain.data)) + across * points_of(plain.data))
    assert np.abs(shown(plain) - exact).max() < (1e-5 if domain != "FACE" else 0.02)
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}


def test_three_attributes_of_numbers_are_a_vector(native, plain):
    """As the importer of PLY leaves them."""
    vectors = np.cross(AXIS, points_of(plain.data))
    for k, name in enumerate(("vx", "vy", "vz")):
        attribute = plain.data.attributes.new(name, "FLOAT", "POINT")
        attribute.data.foreach_set("value", vectors[:, k].astype(np.float32))
    assert bpy.ops.stormfield.field_from_attribute() == {"FINISHED"}
    assert np.abs(shown(plain) - along(plain, vectors)).max() < 1e-5


def turning_tree():
    """Geometry Nodes: the attribute "flow" is the place × an axis whose length is the frame."""
    tree = bpy.data.node_groups.new("Turning", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes, links = tree.nodes, tree.links
    begin, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    time, position, cross = (
        nodes.new("GeometryNodeInputSceneTime"),
        nodes.new("GeometryNodeInputPosition"),
        nodes.new("ShaderNodeVectorMath"),
    )
    cross.operation = "CROSS_PRODUCT"
    axis = nodes.new("ShaderNodeCombineXYZ")
    links.new(time.outputs["Frame"], axis.inputs["Z"])
    links.new(axis.outputs[0], cross.inputs[0])
    links.new(position.outputs[0], cross.inputs[1])
    store = nodes.new("GeometryNodeStoreNamedAttribute")
    store.data_type, store.domain = "FLOAT_VECTOR", "POINT"
    store.inputs["Name"].default_value = "flow"
    links.new(begin.outputs[0], store.inputs["Geometry"])
    value = next(
        socket for socket in store.inputs if socket.name == "Value" and socket.type == "VECTOR" and socket.enabled
    )
    links.new(cross.outputs[0], value)
    links.new(store.outputs[0], end.inputs[0])
    return tree


def test_an_animated_attribute_becomes_the_field_over_lambda(native, plain, scene):
    scene.frame_start, scene.frame_end = 1, 9
    plain.modifiers.new("Turning", "NODES").node_group = turning_tree()
    assert bpy.ops.stormfield.field_from_attribute(attribute="flow", animated=True, step=2) == {"FINISHED"}
    places = points_of(plain.data)
    for frame in (1, 4, 9):  # between samples the field is linear in λ
        scene.frame_set(frame)
        exact = along(plain, np.cross([0.0, 0.0, float(frame)], places))
        assert np.abs(shown(plain) - exact).max() < 1e-4 * frame, frame
    assert plain.stormfield.lam == pytest.approx(1.0)


def test_vectors_on_a_moved_surface_are_brought_back(native, plain):
    """A shape key doubles z: what was made there lies on the mesh at rest again."""
    plain.shape_key_add(name="Basis")
    key = plain.shape_key_add(name="High")
    rest = points_of(plain.data)
    for point, place in zip(key.data, rest, strict=True):
        point.co = (place[0], place[1], 2.0 * place[2])
    key.value = 1.0
    vectors = np.cross(AXIS, rest)
    put(plain.data, "velocity", vectors * [1.0, 1.0, 2.0])  # as the shape key carries a flow along
    assert bpy.ops.stormfield.field_from_attribute(attribute="velocity") == {"FINISHED"}
    from stormfield.cache.field_cache import open_cache
    from stormfield.scene.read.attached import attached_folder

    found = open_cache(attached_folder(plain, LAMBDA)).sample(0)["sf_advection"]
    assert np.abs(found - vectors).max() < 0.01


@pytest.mark.parametrize(
    ("attribute", "words"),
    [("nothing", "no attribute 'nothing'"), ("zero", "zero everywhere"), ("normal", "normals, not a field")],
)
def test_what_is_no_field_is_refused(native, plain, attribute, words):
    put(plain.data, "zero", np.zeros((len(plain.data.vertices), 3)))
    put(plain.data, "normal", points_of(plain.data))
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.stormfield.field_from_attribute(attribute=attribute)
    assert not plain.stormfield.enabled
    with pytest.raises(RuntimeError, match="2 attributes that may be a field"):
        bpy.ops.stormfield.field_from_attribute()


def test_a_mesh_that_modifiers_subdivide_gives_the_vectors_of_its_own(native, plain):
    put(plain.data, "velocity", np.cross(AXIS, points_of(plain.data)))
    plain.modifiers.new("Subdivision", "SUBSURF").levels = 1
    assert bpy.ops.stormfield.field_from_attribute(attribute="velocity") == {"FINISHED"}
    plain.modifiers["Subdivision"].show_viewport = False
    assert np.abs(shown(plain) - along(plain, np.cross(AXIS, points_of(plain.data)))).max() < 1e-4


def test_a_mesh_that_is_no_surface_has_a_field_where_it_is_one(native):
    """A fin on a grid: three faces meet at an edge, which the solve takes apart too."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=2.0)
    obj = bpy.context.object
    places = points_of(obj.data)
    faces = [tuple(polygon.vertices) for polygon in obj.data.polygons]
    edge = faces[5][:2]
    fin = [*places.tolist(), (0.0, 0.0, 1.0)]
    obj.data.clear_geometry()
    obj.data.from_pydata(fin, [], [*faces, (*edge, len(places))])
    put(obj.data, "velocity", np.tile([1.0, 0.5, 0.0], (len(fin), 1)))
    assert bpy.ops.stormfield.field_from_attribute(attribute="velocity") == {"FINISHED"}
    assert np.isfinite(shown(obj)).all() and np.linalg.norm(shown(obj), axis=1).max() > 0.9
