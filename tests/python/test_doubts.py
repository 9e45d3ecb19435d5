# SPDX-License-Identifier: GPL-3.0-or-later
"""What a solve has doubts about, on meshes where the answer is known."""

import numpy as np
import pytest
import stormfield_native as native
from stormfield.analysis.doubts import doubts_of, mean_edge_lengths
from stormfield.model.design import Design, Element

CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BOX = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))], np.int32)


def storm(radius, place=(0.0, 0.0, 1.0)):
    return Element("Eye", "singular", points=(place,), lam=(0.0,), kind="vortex_ccw", radius=radius)


def kinds(vertices, triangles, elements=(), fields=None):
    surface = native.TriangleMesh(vertices, triangles)
    fields = {"sf_advection": np.ones((len(vertices), 3))} if fields is None else fields
    return {doubt.kind: doubt for doubt in doubts_of(surface, Design(elements=tuple(elements)), fields)}


def test_edges_are_measured_at_each_vertex():
    lengths = mean_edge_lengths(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]]))
    assert lengths == pytest.approx([3.5, 4.0, 4.5])


def test_a_cube_is_outward_whole_and_has_no_doubts_for_a_large_storm():
    assert kinds(CUBE, BOX, [storm(10.0)]) == {}


def test_a_cube_is_too_coarse_for_a_small_storm_and_the_cure_is_enough():
    doubt = kinds(CUBE, BOX, [storm(0.17), storm(8.0)])["coarse"]
    assert "'Eye'" in doubt.text and "0.17" in doubt.text
    edge = 2.4 / 2**doubt.amount
    assert 2.0 * edge < 0.17 < 8.0 * edge


def test_streams_are_never_too_thin():
    line = Element("Jet", "streamline", points=((0.0, 0.0, 1.0), (0.5, 0.0, 1.0)), lam=(0.0, 1.0), radius=0.01)
    assert kinds(CUBE, BOX, [line]) == {}


def test_faces_that_point_inward_are_found_and_open_surfaces_have_no_inside():
    assert kinds(CUBE, BOX[:, ::-1]).keys() == {"inward"}
    assert kinds(CUBE, BOX[2:, ::-1]) == {}
    both = np.concatenate([CUBE, CUBE + 5.0])
    doubt = kinds(both, np.concatenate([BOX, BOX[:, ::-1] + 8]))["inward"]
    assert doubt.amount == 1 and "1 part" in doubt.text


def test_a_part_without_field_is_counted_once_for_both_fields():
    both = np.concatenate([CUBE, CUBE + 5.0])
    triangles = np.concatenate([BOX, BOX + 8])
    half = np.repeat([[1.0, 0, 0], [0, 0, 0]], 8, axis=0)
    doubt = kinds(both, triangles, fields={"sf_advection": half, "sf_orientation": np.ones((16, 3))})["no_element"]
    assert doubt.amount == 1 and "1 of the 2 parts" in doubt.text
