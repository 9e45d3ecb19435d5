# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface in meshes of any kind: what the core refuses becomes a manifold, and what it takes stays as it is."""

import numpy as np
import pytest
from stormfield import native
from stormfield.model.manifold import manifold
from stormfield.model.mesh_data import MeshData
from stormfield.readers.icosphere import icosphere


def grid(n=5, lift=0.0):
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    points = np.stack([x.ravel(), y.ravel(), np.full(n * n, lift)], axis=1).astype(float)
    low = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return points, np.concatenate(
        [np.stack([low, low + 1, low + n + 1], axis=1), np.stack([low, low + n + 1, low + n], axis=1)]
    )


def both(*parts):
    """Meshes one after the other."""
    points, triangles, start = [], [], 0
    for part_points, part_triangles in parts:
        points.append(np.asarray(part_points, float))
        triangles.append(np.asarray(part_triangles) + start)
        start += len(part_points)
    return np.concatenate(points), np.concatenate(triangles)


def split(points, triangles):
    """Every triangle with vertices of its own."""
    return points[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)


def cube():
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def ball(level=2):
    mesh = icosphere(20 * 4**level) if level else icosphere(20)
    return np.array(mesh.vertices), np.array(mesh.triangles)


def built(points, triangles, weld=1e-5):
    """The surface, which the core must take."""
    found = manifold(MeshData(points, triangles), weld)
    return found, native.TriangleMesh(found.mesh.vertices, found.mesh.triangles)


@pytest.mark.parametrize("make", [grid, cube, ball])
def test_a_surface_stays_as_it_is(make):
    points, triangles = make()
    mesh = MeshData(points, triangles)
    found = manifold(mesh, 1e-5)
    assert found.same and found.mesh is mesh
    values = np.arange(len(points))
    assert found.to_mesh(values) is values and found.to_surface(values) is values
    assert found.remarks.line() == ""


@pytest.mark.parametrize("make", [grid, cube, ball])
def test_split_faces_are_joined(make):
    points, triangles = make()
    found, surface = built(*split(points, triangles))
    whole = native.TriangleMesh(points, triangles.astype(np.int32))
    assert surface.component_count == 1
    assert surface.vertex_count == len(points)
    assert surface.euler_characteristic == whole.euler_characteristic
    assert len(found.remarks.welded) == triangles.size - len(points)
    assert "seams and split faces" in found.remarks.line()
    values = found.to_mesh(found.mesh.vertices)
    assert np.allclose(values, split(points, triangles)[0])


def test_islands_stay_apart_where_nothing_is_welded():
    _found, surface = built(*split(*grid()), weld=0.0)
    assert surface.component_count == 32


def test_sheets_that_lie_on_each_other_stay_two():
    _found, surface = built(*both(grid(), grid()))
    assert surface.component_count == 2


def test_a_fin_is_cut_off():
    points, triangles = grid()
    row = [10, 11, 12, 13, 14]  # across the middle
    fin = np.array([points[v] + (0, 0, 1) for v in row])
    lifted = [(row[i], row[i + 1], 25 + i) for i in range(4)] + [(row[i + 1], 26 + i, 25 + i) for i in range(4)]
    found, surface = built(np.concatenate([points, fin]), np.concatenate([triangles, lifted]))
    assert surface.component_count == 2
    plane = surface.components[found.number[0]]
    assert (surface.components[found.number[row]] == plane).all()  # the larger piece stands for the edge
    assert set(found.remarks.crowded) == set(row)
    assert "edges with more than two faces" in found.remarks.line()


def test_an_inner_wall_leaves_the_box_closed():
    points, triangles = cube()
    wall = np.array([(0, 1, 7), (0, 7, 6)])  # from edge to edge
    found, surface = built(points, np.concatenate([triangles, wall]))
    sizes = np.bincount(surface.components[surface.triangles[:, 0]])
    assert sorted(sizes) == [2, 12]
    box = surface.components[found.number[0]]
    assert np.count_nonzero(surface.components[surface.triangles[:, 0]] == box) == 12


def test_two_cubes_that_touch_in_an_edge_stay_two_cubes():
    points, triangles = cube()
    other = points + np.array([1, 1, 0])
    joined_points, joined_triangles = both((points, triangles), (other, triangles))
    same = {8 + 0: 6, 8 + 1: 7}
    joined_triangles = np.vectorize(lambda v: same.get(v, v))(joined_triangles)
    _found, surface = built(joined_points, joined_triangles)
    assert surface.component_count == 2
    assert surface.euler_characteristic == 4


def test_a_bow_tie_becomes_two_fans():
    points, triangles = both(grid(3), (grid(3)[0] + (2, 2, 0), grid(3)[1]))
    triangles = np.where(triangles == 9, 8, triangles)
    found, surface = built(points, triangles)
    assert surface.component_count == 2
    assert found.remarks.pinched.tolist() == [8]


def test_a_vertex_on_a_side_makes_no_crack():
    """What Blender makes of a polygon with a vertex on its side: a triangle without area along it."""
    points = np.array([(0, 0, 0), (2, 0, 0), (1, 0, 0), (1, 1, 0), (1, -1, 0)], float)
    triangles = np.array([(0, 1, 3), (0, 2, 1), (2, 0, 4), (1, 2, 4)])
    found, surface = built(points, triangles)
    assert surface.component_count == 1 and surface.face_count == 4
    assert surface.boundary_loop_count == 1 if hasattr(surface, "boundary_loop_count") else True
    assert np.isclose(surface.face_areas.sum(), 2.0)
    assert found.remarks.flat.tolist() == [1]


def test_faces_without_area_and_faces_that_are_there_twice_are_left_out():
    points, triangles = grid()
    more = np.array([triangles[0], triangles[3][::-1], (0, 0, 1), (0, 1, 2)])
    found, surface = built(points, np.concatenate([triangles, more]))
    assert surface.face_count == 32
    assert len(found.remarks.flat) == 2 and len(found.remarks.repeated) == 2


def test_vertices_in_one_place_inside_a_surface_are_one():
    points, triangles = grid()
    points = np.concatenate([points, points[12:13]])
    corner = np.argwhere(triangles == 12)
    triangles = triangles.copy()
    for face, at in corner[: len(corner) // 2]:
        triangles[face, at] = 25
    _found, surface = built(points, triangles)
    assert surface.component_count == 1 and surface.euler_characteristic == 1


def test_inside_out_parts_are_turned_and_cavities_are_not():
    points, triangles = ball()
    outer, inner = (2 * points, triangles), (points, triangles[:, ::-1])
    assert manifold(MeshData(*both(outer, inner)), 1e-5).same
    found = manifold(MeshData(points, triangles[:, ::-1]), 1e-5)
    assert len(found.remarks.inward) == len(triangles)
    assert "point inward" in found.remarks.line()
    assert np.array_equal(np.sort(found.mesh.triangles, axis=1), np.sort(triangles, axis=1))
    corners = found.mesh.vertices[found.mesh.triangles]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()
    assert volume > 0
    island = both((points, triangles), (points + 5, triangles[:, ::-1]))
    assert len(manifold(MeshData(*island), 1e-5).remarks.inward) == len(triangles)


def test_texture_coordinates_follow_their_corners():
    points, triangles = split(*grid())
    uv = {"UVMap": points[triangles][:, :, :2].astype(np.float32)}
    found = manifold(MeshData(points, triangles, uv), 1e-5)
    places = found.mesh.vertices[found.mesh.triangles][:, :, :2]
    assert np.allclose(found.mesh.uv_layers["UVMap"], places)


def test_what_the_core_must_name_is_left_to_it():
    points, triangles = grid()
    points[7] = np.nan
    assert manifold(MeshData(points, triangles), 1e-5).same
    points, triangles = grid()
    triangles[0, 0] = 99
    assert manifold(MeshData(points, triangles), 1e-5).same


def test_any_order_of_triangles_gives_the_same_surface():
    points, triangles = split(*ball())
    rng = np.random.default_rng(3)
    one, _ = built(points, triangles)
    other, _ = built(points, triangles[rng.permutation(len(triangles))])
    assert np.array_equal(one.mesh.vertices, other.mesh.vertices)
    assert np.array_equal(one.number, other.number)
