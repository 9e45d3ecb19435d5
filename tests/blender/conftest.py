# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the add-on in a real Blender (the bpy wheel): every test begins with an empty file."""

import pytest

bpy = pytest.importorskip("bpy", reason="the bpy wheel is not installed")


@pytest.fixture(scope="session", autouse=True)
def addon():
    import stormfield

    stormfield.register()
    yield stormfield
    stormfield.unregister()


@pytest.fixture(autouse=True)
def empty_file(addon):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 50


@pytest.fixture
def scene():
    return bpy.context.scene


@pytest.fixture
def ball(scene):
    """A sphere of radius 1 with a field, active."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0)
    obj = bpy.context.object
    obj.name = "Ball"
    bpy.ops.stormfield.add_field()
    return obj


@pytest.fixture
def native():
    """The core, which not every Blender can load."""
    from stormfield import native

    try:
        native.check()
    except ImportError as fault:
        pytest.skip(str(fault))
    return native


@pytest.fixture
def put_field():
    """Vectors on a mesh, as if a cache had put them there: an array, or a function of the vertices (n, 3)."""
    import numpy as np

    def work(obj, vectors):
        if callable(vectors):
            points = np.empty(len(obj.data.vertices) * 3, np.float32)
            obj.data.vertices.foreach_get("co", points)
            vectors = vectors(points.reshape(-1, 3))
        attributes = obj.data.attributes
        found = attributes.get("sf_advection") or attributes.new("sf_advection", "FLOAT_VECTOR", "POINT")
        found.data.foreach_set("vector", np.asarray(vectors, np.float32).ravel())
        obj.data.update_tag()

    return work


@pytest.fixture
def rings(ball, put_field):
    """The ball with a field in which the equator attracts and both poles repel."""
    import numpy as np

    up = np.array([0.0, 0.0, 1.0])
    put_field(ball, lambda places: np.cross(up, places) - places[:, 2:] * (up - places * places[:, 2:]))
    return ball


@pytest.fixture
def storms(ball, add_curve):
    """The ball with two vortices at the poles' sides and a stream between: a design that solves fast."""
    from stormfield.scene.write.elements import add_element

    for name, x in (("West", -1.0), ("East", 1.0)):
        empty = bpy.data.objects.new(name, None)
        empty.location = (x, 0.0, 0.0)
        bpy.context.scene.collection.objects.link(empty)
        add_element(ball, empty, type="singular", kind="vortex_ccw", radius=0.35)
    ball.stormfield.solve.samples = 5
    return ball


@pytest.fixture
def add_curve(scene):
    def make(points, name="Curve", kind="POLY", cyclic=False):
        data = bpy.data.curves.new(name, "CURVE")
        data.dimensions = "3D"
        spline = data.splines.new(kind)
        if kind == "BEZIER":
            spline.bezier_points.add(len(points) - 1)
            for target, point in zip(spline.bezier_points, points, strict=True):
                target.co = point
                target.handle_left_type = target.handle_right_type = "AUTO"
        else:
            spline.points.add(len(points) - 1)
            for target, point in zip(spline.points, points, strict=True):
                target.co = (*point, 1.0)
        spline.use_cyclic_u = cyclic
        obj = bpy.data.objects.new(name, data)
        scene.collection.objects.link(obj)
        return obj

    return make


@pytest.fixture
def attribute():
    """An attribute of the evaluated mesh as an array."""
    import numpy as np

    def read(obj, name):
        mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        found = mesh.attributes.get(name)
        assert found is not None, f"{name} is not among {mesh.attributes.keys()}"
        width = 3 if found.data_type == "FLOAT_VECTOR" else 1
        values = np.empty(len(mesh.vertices) * width, np.float32)
        found.data.foreach_get("vector" if width == 3 else "value", values)
        return values.reshape(-1, 3) if width == 3 else values

    return read


@pytest.fixture(autouse=True)
def own_temporary_folder(empty_file, tmp_path, monkeypatch):
    """Caches of unsaved files go to a folder of the test."""
    from stormfield.scene.read import folders
    from stormfield.scene.write import cache_folders

    for module in (folders, cache_folders):
        monkeypatch.setattr(module, "temporary_root", lambda: tmp_path / "temporary" / folders.NAME)


@pytest.fixture
def pair(ball):
    """Solved and analyzed at λ 0."""
    from edited_pair import AS_SOLVED, ELEMENTS, kinds
    from stormfield.scene.write.elements import add_element

    if not bpy.app.build_options.usd:
        pytest.skip("this Blender has no USD")
    for number, (kind, place) in enumerate(ELEMENTS):
        empty = bpy.data.objects.new(f"{kind} {number}", None)
        empty.location = place
        bpy.context.scene.collection.objects.link(empty)
        add_element(ball, empty, type="singular", kind=kind, radius=0.3)
    ball.stormfield.solve.samples = 2
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert bpy.ops.stormfield.analyze() == {"FINISHED"}
    assert kinds(ball) == AS_SOLVED
    return ball
