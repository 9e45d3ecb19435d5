# SPDX-License-Identifier: GPL-3.0-or-later
"""What is expected of surfaces that other programs write."""

import json
from collections import Counter

import numpy as np
from command_line import run
from surface_cases import (
    KINDS,
    ball,
    flow,
)  # fmt: skip

POINTS, TRIANGLES = ball()


WSS = flow(POINTS)


NORMALS = POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True)


CENTRES = POINTS[TRIANGLES].mean(axis=1)


def analysis(capsys, path, *options):
    status, out, err = run(capsys, "analyze", path, *options, "--json", "-")
    assert status == 0, err
    content = json.loads(out)
    assert err.count("\n") == 1 and err.startswith(f"read: {path}")
    return content


def kinds(content):
    return Counter(point["kind"] for point in content["fixed_points"])


def assert_right(content):
    """Six fixed points at the ends of the axes, of a closed sphere in one piece."""
    assert kinds(content) == KINDS
    assert content["index_sum"] == content["mesh"]["euler_characteristic"] == 2
    assert content["mesh"]["components"] == 1 and content["mesh"]["boundary_loops"] == 0
    for point in content["fixed_points"]:
        place = np.abs(point["position"])
        axis = {"source": 2, "saddle": 1, "sink": 0}[point["kind"]]
        assert place[axis] > 0.98 * np.linalg.norm(place), point


def changes(content):
    return content["read"]["changes"]


def scalars(names, vectors):
    return {name: vectors[:, k].astype(np.float32) for k, name in enumerate(names)}


def ball_of_tetrahedra():
    points = np.concatenate([POINTS, [[0.0, 0, 0]]])
    return points, np.column_stack([TRIANGLES, np.full(len(TRIANGLES), len(POINTS))])


def write_off(path, header="OFF"):
    rows = [" ".join(map(repr, row)) for row in POINTS.tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in TRIANGLES]
    path.write_text(f"{header}\n# a comment\n{len(POINTS)} {len(TRIANGLES)} 0\n" + "\n".join(rows) + "\n")
    return path
