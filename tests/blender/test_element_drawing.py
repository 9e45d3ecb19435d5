# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements in the view: lines above the surface, rings that follow λ, meetings; list and view select together."""

import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("native")


@pytest.fixture
def add(ball, add_curve):
    from stormfield.scene.write.elements import add_element

    def make(name, points, **settings):
        return add_element(ball, add_curve(points, name), **settings)

    return make


def on_ball(*points):
    return [tuple(np.array(point) / np.linalg.norm(point)) for point in points]


@pytest.fixture
def merging(ball, add):
    """Two storms with straight chords as paths, deep below the surface between their points, and a third."""
    storm = {"type": "singular", "kind": "vortex_ccw", "radius": 0.2}
    add("West", on_ball((-1, -1, 0), (0, -1, 0)), lam_end=0.6, **storm)
    add("East", on_ball((1, -1, 0), (0, -1, 0)), lam_end=0.6, **storm)
    add("One", on_ball((0, -1, 0), (0, -1, 1)), lam_start=0.6, **storm)
    return ball


def drawing(obj):
    from stormfield.ui import element_drawing

    bpy.context.view_layer.update()
    return element_drawing.drawing_of(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))


def sunk(obj, times=(0.3, 0.6)):
    """The share of lines whose middle lies below the surface, by the name of the element."""
    from stormfield.ui import drawing_cache

    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    surface, mesh = drawing_cache.surface_of(evaluated)
    shares = {}
    for shape in drawing(obj).shapes:
        middle = np.concatenate([shape.fixed, shape.ticks, *map(shape.at, times)]).mean(axis=1)
        faces, barycentric, _ = mesh.closest_points(middle)
        below = 0
        for place, face, share in zip(middle, faces, barycentric, strict=True):
            corners = surface.vertices[surface.triangles[face]]
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            if share.min() < 1e-6:  # on an edge no face decides
                normal = share @ surface.normals[surface.triangles[face]]
            below += (place - share @ corners) @ normal <= 0
        shares[shape.name] = below / len(middle)
    return shares


def test_lines_never_sink_into_the_surface(merging):
    assert set(sunk(merging).values()) == {0.0}


def test_lines_never_sink_into_a_coarse_and_bumpy_mesh(add_curve):
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    bpy.ops.stormfield.add_field()
    for name, start, step in (("brow", (-0.55, -0.75, 0.62), 0.04), ("nose", (-0.1, -1.0, 0.1), 0.02)):
        places = [monkey.closest_point_on_mesh((start[0] + step * i, *start[1:]))[1][:] for i in range(13)]
        element = monkey.stormfield.elements.add()
        element.name, element.source, element.radius = name, add_curve(places, name), 0.19
    shares = sunk(monkey, np.linspace(0.0, 1.0, 11))
    assert shares["brow"] == 0.0
    assert shares["nose"] < 0.01  # its wings fold over what the ring crosses


def test_a_ring_goes_round_a_ridge_as_over_a_plane():
    """On a folded sheet the way from the middle is the same as if it lay flat."""
    from stormfield import native
    from stormfield.ui import geodesics
    from stormfield.ui.surface import Surface

    across, along = np.meshgrid(np.linspace(-1.0, 1.0, 9), np.linspace(-1.0, 1.0, 9), indexing="ij")
    flat = np.stack([across.ravel(), along.ravel()], axis=1)

    def folded(places):  # by 90° at 0
        return np.stack([np.minimum(places[:, 0], 0), places[:, 1], np.minimum(-places[:, 0], 0)], axis=1)

    corner = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    triangles = np.concatenate(
        [np.stack([corner, corner + 9, corner + 10], 1), np.stack([corner, corner + 10, corner + 1], 1)]
    ).astype(np.int32)
    surface = Surface(folded(flat), triangles)
    mesh = native.TriangleMesh(surface.vertices, surface.triangles)
    angles = np.linspace(0.0, 2 * np.pi, 40)
    turns = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    centre = np.array([[-0.21, 0.03]])
    (face,), _, _ = mesh.closest_points(folded(centre))
    starts = np.full(40, face), np.repeat(folded(centre), 40, axis=0)
    reached = geodesics.walk(surface, *starts, np.c_[turns, np.zeros(40)], np.full(40, 0.6))
    assert np.allclose(reached, folded(centre + 0.6 * turns), atol=1e-9)
    beyond = geodesics.walk(surface, *starts, np.c_[turns, np.zeros(40)], np.full(40, 9.0))
    assert np.allclose(np.abs(beyond).max(axis=1), 1.0)  # stopped at the border


def test_rings_are_as_smooth_on_a_coarse_ball_as_on_a_fine_one():
    from stormfield import native
    from stormfield.readers.icosphere import icosphere
    from stormfield.ui.element_rings import Rings
    from stormfield.ui.surface import Surface

    for faces in (80, 20_000):
        ball = icosphere(faces)
        on = Surface(ball.vertices, ball.triangles), native.TriangleMesh(ball.vertices, ball.triangles)
        place = np.array([[0.1, -0.95, 0.3]])
        ring = Rings(place, place[0], 0.4, [], on).at(0.0)[0]
        steps = np.diff(ring, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        assert lengths.max() < 1.6 * lengths.min()
        ahead = steps / lengths[:, None]
        assert np.einsum("kd,kd->k", ahead[1:], ahead[:-1]).min() > np.cos(np.radians(40))


def test_a_ring_has_its_radius_and_follows_the_path(merging):
    west = next(shape for shape in drawing(merging).shapes if shape.name == "West")
    for lam, angle in ((0.0, 0.0), (0.3, np.pi / 8), (0.6, np.pi / 4)):
        place = west.place(lam)
        assert np.allclose(np.arctan2(place[0], -place[1]), angle - np.pi / 4, atol=0.03)
        away = np.linalg.norm(west.at(lam)[:40, 0] - place, axis=1)
        assert np.allclose(away, 0.2, atol=0.02)
    assert west.place(0.7) is None and len(west.at(0.7)) == 0


def test_arrows_point_with_the_travel_and_ticks_lie_at_tenths(merging):
    from stormfield.ui import element_shapes as shapes

    west = next(shape for shape in drawing(merging).shapes if shape.name == "West")
    path = west.paths[0]
    heads = shapes.chevrons(path.points, path.normals, 0.3, 0.05)
    for back, tip, _ in heads:
        assert (tip - back)[0] > 0  # to the east
    ticks = shapes.ticks(path.points, path.normals, path.lam, 0.02)
    assert len(ticks) == 7
    assert np.allclose(ticks[3].mean(axis=0), west.place(0.3), atol=1e-6)


@pytest.mark.parametrize(("kind", "turns"), [("vortex_ccw", 1), ("vortex_cw", -1), ("spiral_in_cw", -1)])
def test_signs_turn_as_the_flow(kind, turns):
    from stormfield.ui import element_shapes as shapes

    arc = shapes.sign(kind)[0]
    crossed = arc[0, 0] * arc[-1, 1] - arc[0, 1] * arc[-1, 0]
    assert np.sign(crossed) == turns
    radius = np.linalg.norm(arc, axis=1)
    assert (radius[-1] < radius[0] - 0.1) == kind.startswith("spiral_in")


def test_where_paths_meet_is_said(merging):
    (mark,) = drawing(merging).meetings
    assert mark.words == "merge at λ 0.60, frame 30"
    assert np.allclose(mark.position / np.linalg.norm(mark.position), (0, -1, 0), atol=0.02)


def test_a_shape_is_kept_until_its_element_changes(merging):
    before = {shape.name: shape for shape in drawing(merging).shapes}
    assert drawing(merging) is drawing(merging)
    merging.stormfield.elements["West"].radius = 0.3
    after = {shape.name: shape for shape in drawing(merging).shapes}
    assert after["West"] is not before["West"] and after["West"].radius == pytest.approx(0.3)
    assert after["East"] is before["East"]
    merging.stormfield.elements["East"].enabled = False
    assert {shape.name for shape in drawing(merging).shapes} == {"West", "One"}


def test_curves_are_read_as_blender_evaluates_them(ball, add_curve):
    from stormfield.scene.read.curves import read_polylines
    from stormfield.scene.read.element_lines import element_lines
    from stormfield.ui.element_shapes import resampled

    points = [(0, -1, 0), (0.5, -1, 0.3), (1, -0.5, 0), (1, 0.3, 0.2)]
    for kind in ("BEZIER", "NURBS", "POLY"):
        curve = add_curve(points, kind, kind)
        curve.data.splines[0].resolution_u = 12
        if kind == "NURBS":
            curve.data.splines[0].order_u, curve.data.splines[0].use_endpoint_u = 3, True
        bpy.context.view_layer.update()
        (mine,) = element_lines(ball, curve)
        (exact,) = read_polylines(curve, bpy.context.evaluated_depsgraph_get(), ball.matrix_world.inverted())
        away = np.linalg.norm(exact[:, None] - resampled(mine, 0.005)[None], axis=2).min(axis=1)
        assert away.max() < 0.01, kind
        assert np.allclose(mine[0], exact[0], atol=1e-4) and np.allclose(mine[-1], exact[-1], atol=1e-4)


def test_the_list_follows_the_view(merging):
    from stormfield.session import view_selection

    for name in ("East", "West"):
        bpy.context.view_layer.objects.active = merging.stormfield.elements[name].source
        view_selection.follow(bpy.context.scene)
        assert merging.stormfield.active().name == name
    bpy.context.view_layer.objects.active = merging
    view_selection.follow(bpy.context.scene)
    assert merging.stormfield.active().name == "West"


def test_a_click_in_the_list_selects_in_the_view_and_a_script_does_not(merging):
    bpy.context.view_layer.objects.active = merging
    merging.stormfield.active_element = 0
    assert bpy.context.view_layer.objects.active == merging
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "UI")
    with bpy.context.temp_override(window=window, area=area, region=region):
        merging.stormfield.active_element = 1
        assert bpy.context.view_layer.objects.active.name == "East"
        assert [obj.name for obj in bpy.context.selected_objects] == ["East"]


def test_drawing_changes_nothing_in_the_file(merging):
    before = {name: len(getattr(bpy.data, name)) for name in ("objects", "curves", "meshes")}
    drawing(merging)
    assert {name: len(getattr(bpy.data, name)) for name in before} == before


@pytest.fixture
def looking(monkeypatch):
    """A view of 400 × 400 pixels along -Y onto the square from -2 to 2, without a window."""
    from types import SimpleNamespace

    from mathutils import Matrix
    from stormfield.ui import pick

    monkeypatch.setattr(pick, "_hidden", lambda _context, _evaluated, place: place[1] > 0.1)
    turned = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
    return SimpleNamespace(
        region=SimpleNamespace(width=400, height=400),
        region_data=SimpleNamespace(perspective_matrix=Matrix.Diagonal((0.5, 0.5, 0.1, 1.0)) @ turned),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )


def test_a_click_on_a_path_or_ring_finds_its_element(merging, looking):
    from stormfield.ui import pick

    drawing(merging)
    evaluated = merging.evaluated_get(bpy.context.evaluated_depsgraph_get())

    def at(x, z):
        found = pick.element_at(looking, merging, evaluated, (200 + 100 * x, 200 + 100 * z))
        return None if found is None else merging.stormfield.elements[found].name

    assert at(-0.35, 0.0) == "West" and at(0.35, 0.01) == "East" and at(0.0, 0.35) == "One"
    assert at(-0.71, 0.2) == "West"  # its ring at λ 0
    assert at(0.0, -0.5) is None


def test_selecting_an_element_selects_its_source(merging):
    bpy.context.view_layer.objects.active = merging
    assert bpy.ops.stormfield.select_element(index=1) == {"FINISHED"}
    assert bpy.context.view_layer.objects.active.name == "East" and merging.stormfield.active().name == "East"
    assert bpy.ops.stormfield.select_element(index=7) == {"CANCELLED"}
