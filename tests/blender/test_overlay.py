# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay draws, without a window: places, strokes, fixed points, and when they are worked out again."""

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def surface(ball):
    from stormfield.scene.read.mesh import read_mesh
    from stormfield.ui.surface import Surface

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


@pytest.fixture
def seeds(surface):
    from stormfield.ui.stroke_seeds import SeedLevels

    levels = SeedLevels(surface)
    levels.refine(0.1)
    return levels


def turning(points):
    return np.cross([0.0, 0.0, 1.0], points)


@pytest.fixture
def grids(surface, native, seeds):
    from stormfield.ui.strokes import Grids

    return Grids(surface, native.TriangleMesh(surface.vertices, surface.triangles), seeds)


def test_seeds_are_spread_evenly_and_stay_when_finer_ones_join(surface, seeds):
    expected = 4 * np.pi / 0.1**2
    assert 0.4 * expected < len(seeds) < 1.5 * expected
    halves = [int((seeds.positions[:, axis] > 0).sum()) for axis in range(3)]
    assert all(abs(half / len(seeds) - 0.5) < 0.08 for half in halves)
    away = np.linalg.norm(seeds.positions[:, None] - seeds.positions[None], axis=2)
    np.fill_diagonal(away, np.inf)
    assert np.percentile(away.min(axis=1) / seeds.spacing[-1], 5) > 0.4
    assert (np.diff(seeds.spacing) <= 0).all()
    before = seeds.positions.copy()
    seeds.refine(0.04)
    assert len(seeds) > 2 * len(before) and np.array_equal(seeds.positions[: len(before)], before)


def test_a_part_behind_another_takes_none_of_its_places(surface):
    from stormfield.ui.stroke_seeds import SeedLevels
    from stormfield.ui.surface import Surface

    inner = Surface(
        np.concatenate([surface.vertices, 0.97 * surface.vertices]),
        np.concatenate([surface.triangles, surface.triangles + len(surface.vertices)]),
    )
    numbers = []
    for parts in (None, np.repeat([0, 1], len(surface.triangles))):
        seeds = SeedLevels(inner, parts)
        seeds.refine(0.1)
        numbers.append((np.linalg.norm(seeds.positions, axis=1) > 0.98).sum())
    assert numbers[1] > 1.45 * numbers[0]


def test_strokes_follow_the_field_and_float_above_the_surface(surface, grids, seeds):
    from stormfield.ui.strokes import strokes
    from stormfield.ui.surface import LIFT

    chosen = np.arange(len(seeds))
    grids.prepare(chosen, np.full(len(chosen), 0.12))
    drawn = strokes(grids, chosen, turning(surface.vertices).astype(np.float32))
    start, end = drawn.points[:, :-1], drawn.points[:, 1:]
    flow = turning(0.5 * (start + end))
    speed, length = np.linalg.norm(flow, axis=2), np.linalg.norm(end - start, axis=2)
    clear = speed > 0.3  # away from the fixed points
    assert clear.sum() > 1000
    assert (np.einsum("kpd,kpd->kp", end - start, flow)[clear] > 0.99 * (length * speed)[clear]).all()
    height = np.linalg.norm(drawn.points, axis=2)
    assert height.max() < 1.0 + 1.5 * LIFT * surface.size and height.min() > 0.995
    circles = np.ptp(drawn.points[:, :, 2], axis=1)  # each stays at its latitude
    assert circles.max() < 0.01


def test_strokes_never_sink_into_a_bumpy_surface(native):
    from stormfield.ui.stroke_seeds import SeedLevels
    from stormfield.ui.strokes import Grids, strokes
    from stormfield.ui.surface import Surface

    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    monkey.modifiers.new("Smooth", "SUBSURF").levels = 2
    mesh = monkey.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    mesh.calc_loop_triangles()
    surface = Surface(
        np.array([vertex.co for vertex in mesh.vertices], float),
        np.array([triangle.vertices for triangle in mesh.loop_triangles], np.int32),
    )
    triangles = native.TriangleMesh(surface.vertices, surface.triangles)
    seeds = SeedLevels(surface)
    seeds.refine(0.15)
    grids = Grids(surface, triangles, seeds)
    chosen = np.arange(len(seeds))
    grids.prepare(chosen, np.full(len(chosen), 0.2))
    values = np.cross([0.3, 0.2, 1.0], surface.vertices).astype(np.float32)
    points = strokes(grids, chosen, values).points.reshape(-1, 3).astype(float)
    _, _, places, normals = grids._nearest(points)
    above = np.einsum("kd,kd->k", points - places, normals)
    assert (above > 0).mean() > 0.99
    assert 0.05 < grids.reach.mean() < 0.2  # shorter only where it must be


def test_strokes_turn_around_a_vortex_at_their_seed(surface, grids, seeds):
    """Exact streamlines of a rotation are circles; a stroke beside the axis is an arc of one."""
    from stormfield.ui.strokes import strokes

    chosen = np.flatnonzero(seeds.positions[:, 2] > 0.97)
    grids.prepare(chosen, np.full(len(chosen), 0.2))
    drawn = strokes(grids, chosen, turning(surface.vertices).astype(np.float32))
    radius = np.linalg.norm(drawn.points[:, :, :2], axis=2)
    assert (np.ptp(radius, axis=1) < 0.02).all()


def test_the_work_of_strokes_does_not_grow_with_the_mesh(grids, seeds):
    grids.prepare(np.arange(len(seeds)), np.full(len(seeds), 0.1))
    assert grids.vertices.shape == (len(seeds), 9, 3)
    before = grids.places.copy()
    seeds.refine(0.05)
    grids.prepare(np.arange(len(seeds)), np.full(len(seeds), 0.1))
    assert np.array_equal(grids.places[: len(before)], before)


@pytest.fixture
def seen():
    """A view of the ball from a distance along -Y, in perspective."""
    from stormfield.ui.stroke_view import View

    def make(distance, size=(800.0, 600.0)):
        near, far, focus = 0.01, 100.0, 2.0
        lens = np.array(
            [
                [focus * size[1] / size[0], 0, 0, 0],
                [0, focus, 0, 0],
                [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
                [0, 0, -1, 0],
            ]
        )
        camera = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -distance], [0, 0, 0, 1]], float)
        return View(lens @ camera, size, 0.5 * size[1] * focus, np.array([0.0, -distance, 0.0, 1.0]))

    return make


def test_strokes_keep_their_distance_on_screen_and_their_places_while_zooming(surface, native, seeds, seen):
    from stormfield.ui.stroke_view import ViewStrokes

    view = ViewStrokes(surface, native.TriangleMesh(surface.vertices, surface.triangles), seeds)
    numbers, places = [], []
    for distance in (6.0, 3.5, 2.2, 1.3, 1.05):
        view._choose(seen(distance), spacing=20.0, length=2.0)
        clip = np.c_[seeds.positions[view.chosen], np.ones(len(view.chosen))] @ seen(distance).projection.T
        pixels = 0.5 * clip[:, :2] / clip[:, 3:] * (800.0, 600.0)
        front = -seeds.positions[view.chosen][:, 1] > (0.8 if distance > 2.0 else 0.98)
        away = np.linalg.norm(pixels[front][:, None] - pixels[front][None], axis=2)
        np.fill_diagonal(away, np.inf)
        numbers.append(np.median(away.min(axis=1)))
        places.append(set(view.chosen[front].tolist()))
        assert len(view.chosen) == 0 or seeds.normals[view.chosen][:, 1].min() < 0
    assert max(numbers) < 1.7 * min(numbers) and 12 < min(numbers) < 25
    assert places[0] <= places[1]


def test_only_what_changed_is_worked_out_again(surface, native, seeds, seen, monkeypatch):
    from stormfield.ui import stroke_view

    made = []
    monkeypatch.setattr(stroke_view, "StrokeBatch", lambda drawn, *_: made.append(drawn) or drawn)
    view = stroke_view.ViewStrokes(surface, native.TriangleMesh(surface.vertices, surface.triangles), seeds)
    values = turning(surface.vertices).astype(np.float32)
    first = view.batch(seen(4.0), values, 1, 20.0, 2.0)
    assert view.batch(seen(4.0), values, 1, 20.0, 2.0) is first and len(made) == 1
    assert view.batch(seen(4.0), -values, 2, 20.0, 2.0) is not first and len(made) == 2
    prepared = view.grids.reach.copy()
    view.batch(seen(3.9), -values, 2, 20.0, 2.0)
    assert (view.grids.reach[prepared > 0] == prepared[prepared > 0]).mean() > 0.8  # a small zoom changes few grids


def test_an_empty_or_flat_object_has_no_strokes(seen):
    from stormfield.ui.stroke_seeds import SeedLevels
    from stormfield.ui.stroke_view import ViewStrokes
    from stormfield.ui.surface import Surface

    for vertices, triangles in ((np.zeros((0, 3)), np.zeros((0, 3), np.int32)), (np.zeros((3, 3)), [[0, 1, 2]])):
        surface = Surface(vertices, np.array(triangles, np.int32))
        view = ViewStrokes(surface, None, SeedLevels(surface))
        batch = view.batch(seen(4.0), np.zeros((len(vertices), 3), np.float32), 1, 20.0, 2.0)
        assert batch.count == 0


def test_no_field_means_no_drawing(show):
    assert show() is None


def test_fixed_points_come_from_the_attribute_on_the_mesh(ball, show):
    drawing = show(np.cross([0.0, 0.0, 1.0], vertices(ball)))
    kinds = sorted(kind for kind, _position in drawing.points)
    assert kinds == ["storm", "storm"]
    assert np.allclose(sorted(float(p[2]) for _kind, p in drawing.points), [-1, 1], atol=0.02)


def test_parts_of_the_mesh_without_field_have_no_marks(show):
    bpy.ops.mesh.primitive_monkey_add()  # head and two eyes
    monkey = bpy.context.object
    bpy.ops.stormfield.add_field()
    values = np.zeros((len(monkey.data.vertices), 3))
    drawing = show(values, monkey)
    assert drawing.points == [] and drawing.note == ""


def test_a_drawing_is_kept_until_something_changes(ball, show):
    values = turning(vertices(ball))
    first = show(values)
    assert show() is first
    assert show(-values) is not first
    second = show()
    ball.stormfield.look.show_fixed_points = False
    assert show() is not second and show().points == []
    ball.data.vertices[0].co.x += 0.01
    assert show(values) is not second


@pytest.fixture
def fan():
    """Three faces at one edge."""
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    mesh = bpy.data.meshes.new("Fan")
    points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
    mesh.from_pydata(points, [], [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
    obj.data = mesh
    bpy.ops.stormfield.add_field()
    return obj


def test_a_mesh_with_fins_is_drawn_on_the_surface_that_a_solve_takes(show, fan):
    from stormfield.ui import drawing_cache

    drawing = show(np.ones((5, 3)), fan)
    surface, mesh = drawing_cache.surface_of(fan.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    assert drawing.note == "" and mesh is not None and len(drawing.values) == len(surface.vertices)
    assert len(surface.triangles) == 3
    assert np.array_equal(surface.triangle_values(np.array([5, 6, 7])), np.array([5, 6, 7])[surface.taken.triangles])


def test_lines_lie_outside_where_normals_point_inward(ball, show):
    from stormfield.ui import drawing_cache
    from stormfield.ui.surface import lift

    ball.data.flip_normals()
    show(turning(vertices(ball)))
    surface, mesh = drawing_cache.surface_of(ball.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    raised, normals = lift(vertices(ball)[:50], surface, mesh)
    assert (np.linalg.norm(raised, axis=1) > 1.0).all() and ((raised * normals).sum(axis=1) > 0).all()


def test_where_there_is_no_surface_at_all_it_is_said_and_the_field_is_there(show):
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    mesh = bpy.data.meshes.new("Flat")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [], [(0, 1, 2)])
    obj.data = mesh
    bpy.ops.stormfield.add_field()
    drawing = show(np.ones((3, 3)), obj)
    assert "Fixed points cannot be shown" in drawing.note and drawing.points == [] and len(drawing.values) == 3


def test_a_mesh_that_is_no_surface_has_straight_strokes(seen):
    from stormfield.ui.stroke_seeds import SeedLevels
    from stormfield.ui.strokes import Grids, strokes
    from stormfield.ui.surface import Surface

    corners = np.array([(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0)], float)
    surface = Surface(corners, np.array([(0, 1, 2), (0, 1, 3), (0, 1, 4)], np.int32))
    seeds = SeedLevels(surface)
    seeds.refine(0.1)
    grids = Grids(surface, None, seeds)
    chosen = np.arange(len(seeds))
    grids.prepare(chosen, np.full(len(seeds), 0.1))
    drawn = strokes(grids, chosen, np.tile(np.float32([0, 0, 1]), (5, 1)))
    along = np.diff(drawn.points, axis=1)
    assert np.allclose(along[:, :, :2], 0.0, atol=1e-5) and (along[:, :, 2] > 0).all()


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


def test_a_storm_is_a_storm_whether_it_draws_in_or_pushes_out_a_little(ball, show):
    points = vertices(ball)
    outward = points * (1.0, 1.0, 0.0)
    for push in (-0.2, 0.0, 0.2):
        kinds = [kind for kind, _ in show(turning(points) + push * outward).points]
        assert kinds == ["storm", "storm"]
    assert "storm" not in [kind for kind, _ in show(0.2 * turning(points) + outward).points]


def test_the_legend_never_covers_more_than_a_tenth_of_the_view():
    from stormfield.ui import legend

    blocks = [legend.Block("Advection", (("source", "Source  1"),) * 4), legend.Block("Topology", (("sink", "x"),) * 5)]
    everything, _ = legend.layout(blocks, (1600.0, 1000.0), 1.0, folded=False)
    assert everything == blocks
    for size in ((1600.0, 1000.0), (800.0, 500.0), (500.0, 300.0), (300.0, 200.0), (100.0, 100.0)):
        for unit in (1.0, 1.9):
            shown, box = legend.layout(blocks, size, unit, folded=False)
            assert box.width * box.height <= 0.1 * size[0] * size[1]
            assert len(shown) in {0, 1, 2}
    shown, box = legend.layout(blocks, (1600.0, 1000.0), 1.0, folded=True)
    assert [block.title for block in shown] == ["Advection"] and not shown[0].rows
    assert legend.Box(10, 10, 20, 20).holds(15, 29) and not legend.Box(10, 10, 20, 20).holds(31, 15)


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


def test_what_is_nearer_than_the_clipping_plane_asks_for_no_strokes():
    """A place right before the eye would ask for finer and finer levels, and the view would stand still."""
    from stormfield.ui.stroke_view import View

    near, far = 0.1, 100.0
    depth = [0.0, 0.0, -(far + near) / (far - near), -2.0 * far * near / (far - near)]
    projection = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], depth, [0.0, 0.0, -1.0, 0.0]])
    view = View(projection, (800.0, 600.0), 300.0, np.array([0.0, 0.0, 0.0, 1.0]))
    pixels, inside = view.pixels_per_unit(np.array([(0.0, 0.0, -1e-7), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]))
    assert inside.tolist() == [False, True, False]
    assert pixels.max() == pytest.approx(300.0)
