# SPDX-License-Identifier: GPL-3.0-or-later
"""Data sets as fields: formats, wind on a sphere, and what is refused."""

import json

import meshio
import numpy as np
import pytest
from data_sets import data_set
from stormfield.model.errors import InputError
from stormfield.readers import Choice, read_field, read_mesh
from stormfield.readers.icosphere import icosphere

TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]], float)
VECTORS = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12]], float)


# Files ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "vertices", "faces"),
    [
        ("bunny1V.t", 6002, 12000),
        ("torus1V.t", 4608, 9216),
        ("gasEngineV.t", 13151, 26298),
        ("sphere1.ply", 4098, 8192),
        ("simple_fld2.ply", 3169, 6144),
    ],
)
def test_the_thesis_data_are_read(name, vertices, faces):
    data = read_field(data_set(name))
    assert data.mesh.vertices.shape == (vertices, 3)
    assert data.mesh.triangles.shape == (faces, 3)
    assert data.vectors.shape == (1, vertices, 3)


def test_t_file(tmp_path):
    rows = ["2 4", "", "0 1 2", "0 2 3"] + [" ".join(map(str, row)) for row in (*POINTS, *VECTORS)]
    (tmp_path / "a.t").write_text("\n".join(rows))
    data = read_field(tmp_path / "a.t")
    assert np.array_equal(data.mesh.vertices, POINTS)
    assert np.array_equal(data.mesh.triangles, TRIANGLES)
    assert np.array_equal(data.at(0.7), VECTORS)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "does not begin"),
        ("two 4", "does not begin"),
        ("2 4\n0 1 2\n", "need 32"),
        ("0 0", "need 2"),
        ("1 3\n0 1 x\n" + "0 0 0\n" * 6, "word where a number"),
        ("1 3\n0 1 2\n" + "0 0 0\n" * 5 + "0 0 nan\n", "vertex 2 is not finite"),
    ],
)
def test_bad_t_files_are_refused(tmp_path, content, words):
    (tmp_path / "a.t").write_text(content)
    with pytest.raises(InputError, match=words):
        read_field(tmp_path / "a.t")


@pytest.mark.parametrize("ending", ["ply", "vtu", "vtk"])
def test_meshio_formats_with_named_vectors(tmp_path, ending):
    split = {"wx": VECTORS[:, 0], "wy": VECTORS[:, 1], "wz": VECTORS[:, 2]}
    meshio.write(tmp_path / f"a.{ending}", meshio.Mesh(POINTS, [("triangle", TRIANGLES)], point_data=split))
    data = read_field(tmp_path / f"a.{ending}", Choice("wx, wy, wz"))
    assert np.array_equal(data.vectors[0], VECTORS)
    with pytest.raises(InputError, match=r"no array 'wq'.*wx .*wy .*wz"):
        read_field(tmp_path / f"a.{ending}", Choice("wx,wy,wq"))
    assert np.array_equal(read_field(tmp_path / f"a.{ending}").vectors[0], VECTORS)


def test_the_only_vector_needs_no_name_and_polygons_become_triangles(tmp_path):
    quad = meshio.Mesh(POINTS, [("quad", [[0, 1, 2, 3]])], point_data={"velocity": VECTORS})
    meshio.write(tmp_path / "a.vtu", quad)
    data = read_field(tmp_path / "a.vtu")
    assert np.array_equal(data.mesh.triangles, [[0, 1, 3], [1, 2, 3]])  # along the shorter diagonal
    assert np.array_equal(data.vectors[0], VECTORS)


@pytest.mark.parametrize("name", ["a.obj", "a.txt", "a.ply"])
def test_files_that_are_no_data_are_refused_in_one_line(tmp_path, name, capsys):
    (tmp_path / name).write_bytes(b"\x00nonsense\n")
    with pytest.raises(InputError) as fault:
        read_field(tmp_path / name)
    assert name in str(fault.value)
    assert capsys.readouterr().out == ""


def test_a_mesh_without_faces_and_a_missing_file_are_refused(tmp_path):
    meshio.write(tmp_path / "a.vtu", meshio.Mesh(POINTS, [("line", [[0, 1]])]))
    with pytest.raises(InputError, match="no faces"):
        read_mesh(tmp_path / "a.vtu")
    with pytest.raises(InputError, match="no such file"):
        read_mesh(tmp_path / "b.vtu")


# Spheres and wind -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("wanted", "found"), [(20, 20), (100, 80), (1000, 980), (20480, 20480)])
def test_icosphere(wanted, found):
    mesh = icosphere(wanted)
    assert len(mesh.triangles) == found
    assert len(mesh.vertices) == found // 2 + 2
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1.0)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normals, a + b + c) > 0).all()
    edges = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]))
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


@pytest.mark.parametrize("faces", [0, 19, 10**9])
def test_spheres_out_of_range_are_refused(faces):
    with pytest.raises(InputError, match="faces"):
        icosphere(faces)


def test_michael_turns_counter_clockwise_over_the_gulf():
    """The strongest cyclone of the box is where the data's own README puts it."""
    data = read_field(data_set("gfs_wind_michael_2018.npz"), Choice(sphere_faces=80000))
    points = data.mesh.vertices / np.linalg.norm(data.mesh.vertices, axis=1, keepdims=True)
    latitude, longitude = np.degrees(np.arcsin(points[:, 2])), np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    wind = data.vectors[26]  # the 10th, 00:00: eye at 27 N 87 W
    for offset, component, sign in (((0, 2), "n", 1), ((0, -2), "n", -1), ((2, 0), "e", -1), ((-2, 0), "e", 1)):
        vertex = np.argmin((latitude - 27 - offset[0]) ** 2 + (longitude + 87 - offset[1]) ** 2)
        theta = np.radians(longitude[vertex])
        east = np.array([-np.sin(theta), np.cos(theta), 0])
        direction = east if component == "e" else np.cross(points[vertex], east)
        assert sign * wind[vertex] @ direction > 5.0, json.dumps(offset)
