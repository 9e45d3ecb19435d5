# SPDX-License-Identifier: GPL-3.0-or-later
"""The rotation of rigid motion is twice its angular speed; a field from a potential has none."""

import numpy as np
from stormfield.cache.rotation import Rotation
from stormfield.native import TriangleMesh


def disc(steps: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """A flat square grid, seen from +z."""
    axis = np.linspace(-1, 1, steps)
    x, y = np.meshgrid(axis, axis)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    corner = (np.arange(steps - 1)[:, None] * steps + np.arange(steps - 1)).ravel()
    squares = np.stack([corner, corner + 1, corner + steps + 1, corner + steps], axis=1)
    return vertices, np.concatenate([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]]).astype(np.int32)


def test_rigid_rotation_has_twice_its_angular_speed():
    vertices, triangles = disc()
    vectors = 1.5 * np.cross([0.0, 0.0, 1.0], vertices)
    assert np.allclose(Rotation(TriangleMesh(vertices, triangles)).of(vectors), 3.0)
    assert np.allclose(Rotation(TriangleMesh(vertices, triangles[:, ::-1])).of(vectors), -3.0)


def test_a_source_has_none():
    vertices, triangles = disc()
    assert np.allclose(Rotation(TriangleMesh(vertices, triangles)).of(vertices), 0.0)


def test_vertices_without_faces_have_none():
    vertices, triangles = disc()
    vertices = np.vstack([vertices, [5.0, 5.0, 5.0]])
    assert Rotation(TriangleMesh(vertices, triangles)).of(vertices)[-1] == 0.0
