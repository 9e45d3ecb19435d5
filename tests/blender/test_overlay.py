# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay draws, without a window: places, strokes, fixed points, and when they are worked out again."""

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def surface(ball):
    from stormfield.scene.read.mesh import read_mesh
    from stormfield.ui.field_drawing import Surface

    mesh = read_mesh(ball)
    return Surface(mesh.vertices, mesh.triangles)


@pytest.fixture
def show(ball):
    """Put vectors onto the mesh as if a cache had, and let the overlay work."""
    from stormfield.ui import drawing_cache

    def work(values=None, obj=ball):
        if values is not None:
            name = obj.stormfield.look.shown_field
            attribute = obj.data.attributes.get(name) or obj.data.attributes.new(name, "FLOAT_VECTOR", "POINT")
            attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
            obj.data.update_tag()
            depsgraph = bpy.context.evaluated_depsgraph_get()
            drawing_cache.mark_changed(depsgraph)
        return drawing_cache.drawing_of(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))

    drawing_cache.forget()
    return work


def vertices(obj):
    return np.array([vertex.co for vertex in obj.data.vertices])


def test_seeds_are_spread_evenly_and_stay(surface):
    from stormfield.ui.field_drawing import spread_seeds

    seeds = spread_seeds(surface, 20)
    places = np.einsum("kc,kcd->kd", seeds.barycentric, surface.vertices[surface.triangles[seeds.faces]])
    expected = 4 * np.pi / seeds.spacing**2
    assert 0.4 * expected < len(places) < 2.5 * expected
    halves = [int((places[:, axis] > 0).sum()) for axis in range(3)]
    assert all(abs(half / len(places) - 0.5) < 0.08 for half in halves)
    again = spread_seeds(surface, 20)
    assert np.array_equal(seeds.faces, again.faces) and np.array_equal(seeds.barycentric, again.barycentric)


def test_strokes_follow_the_field_and_float_above_the_surface(surface, native):
    from stormfield.ui.field_drawing import LIFT, spread_seeds, strokes

    mesh = native.TriangleMesh(surface.vertices, surface.triangles)
    values = np.cross([0.0, 0.0, 1.0], surface.vertices)
    drawn = strokes(surface, mesh, values, spread_seeds(surface, 12), 2.0)
    start, end = drawn.lines[:, 0], drawn.lines[:, 1]
    flow = np.cross([0.0, 0.0, 1.0], 0.5 * (start + end))
    speed, length = np.linalg.norm(flow, axis=1), np.linalg.norm(end - start, axis=1)
    clear = (speed > 0.3) & (length > 1e-3)  # away from the fixed points, and longer than the steps between faces
    assert clear.sum() > 100
    assert (np.einsum("ld,ld->l", end - start, flow)[clear] > 0.95 * (length * speed)[clear]).all()
    height = np.linalg.norm(drawn.lines, axis=2)
    assert height.max() < 1.0 + 1.5 * LIFT * surface.size and height.min() > 0.98
    assert drawn.along.min() == 0.0 and drawn.along.max() <= 1.0 + 1e-9
    assert (np.diff(drawn.along, axis=1) >= 0).all()


def test_no_field_means_no_drawing(show):
    assert show() is None


def test_fixed_points_come_from_the_attribute_on_the_mesh(ball, show):
    drawing = show(np.cross([0.0, 0.0, 1.0], vertices(ball)))
    kinds = sorted(kind for kind, _position in drawing.points)
    assert kinds == ["center", "center"]
    assert np.allclose(sorted(float(p[2]) for _kind, p in drawing.points), [-1, 1], atol=0.02)


def test_parts_of_the_mesh_without_field_have_no_marks(show):
    bpy.ops.mesh.primitive_monkey_add()  # head and two eyes
    monkey = bpy.context.object
    bpy.ops.stormfield.add_field()
    values = np.zeros((len(monkey.data.vertices), 3))
    drawing = show(values, monkey)
    assert drawing.points == [] and drawing.note == ""


def test_a_drawing_is_kept_until_something_changes(ball, show):
    turning = np.cross([0.0, 0.0, 1.0], vertices(ball))
    first = show(turning)
    assert show() is first
    assert show(-turning) is not first
    second = show()
    ball.stormfield.look.style = "ARROWS"
    arrows = show()
    assert arrows is not second and len(arrows.lines) % 3 == 0
    ball.stormfield.look.style = "NONE"
    assert len(show().lines) == 0 and len(show().points) == 2


def test_arrows_are_tangent(ball, show):
    ball.stormfield.look.style = "ARROWS"
    lines = show(np.cross([0.0, 0.0, 1.0], vertices(ball))).lines[::3]
    shaft = lines[:, 1] - lines[:, 0]
    outward = lines[:, 0] / np.linalg.norm(lines[:, 0], axis=1, keepdims=True)
    assert (np.abs((shaft * outward).sum(axis=1)) <= 0.1 * np.linalg.norm(shaft, axis=1) + 1e-9).all()


def test_a_mesh_that_is_no_surface_says_why_and_still_shows_arrows(show):
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    mesh = bpy.data.meshes.new("Fan")
    points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
    mesh.from_pydata(points, [], [(0, 1, 2), (0, 1, 3), (0, 1, 4)])  # three faces at one edge
    obj.data = mesh
    bpy.ops.stormfield.add_field()
    drawing = show(np.ones((5, 3)), obj)
    assert "Fixed points cannot be shown" in drawing.note and not drawing.points
    assert len(drawing.lines)


def test_the_overlay_writes_nothing(ball, show):
    values = np.cross([0.0, 0.0, 1.0], vertices(ball))
    show(values)
    before = np.empty(len(ball.data.vertices) * 3, np.float32)
    ball.data.attributes["sf_advection"].data.foreach_get("vector", before)
    show()
    after = np.empty_like(before)
    ball.data.attributes["sf_advection"].data.foreach_get("vector", after)
    assert np.array_equal(before, after)
    assert sorted(a.name for a in ball.data.attributes if a.name.startswith("sf_")) == ["sf_advection"]


@pytest.mark.parametrize("kind", ["source", "sink", "saddle", "center", "degenerate", "unknown"])
def test_markers_are_triangles_with_colours(kind):
    from stormfield.ui import markers

    corners, colours = markers.triangles(kind)
    assert len(corners) == len(colours) and len(corners) % 3 == 0
    assert np.abs(corners).max() <= 1.3 and colours.shape[1] == 4


def test_kinds_differ_in_shape_and_colour():
    from stormfield.ui import markers

    looks = {markers.triangles(kind)[1].tobytes() + markers.triangles(kind)[0].tobytes() for kind in markers.NAMES}
    assert len(looks) == len(markers.NAMES)
