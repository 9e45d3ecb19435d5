# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of the core that mypy must accept, and calls that it must refuse. Read by `make lint`, never run: mypy reports
an ignored line that has no fault (warn_unused_ignores), so that a core it could not see would fail here."""

from __future__ import annotations

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

from addon import native
from addon.bake.task import ExrSettings, MorseSettings
from addon.model.design import Element
from addon.model.words import FixedPointKind, MorseKind
from addon.solve import Solution
from addon.work import Steps, result_of


def accepted(mesh: native.TriangleMesh, field: native.VectorField, solution: Solution) -> Steps[None]:
    assert_type(native.fixed_points(field)[0].kind, FixedPointKind)
    assert_type(native.morse(field, "tau", tau=0.3).sets[0].kind, MorseKind)
    assert_type(solution.fields["advection"].at(0.5), native.VectorField)
    assert_type(mesh.vertex_count, int)
    assert_type((yield from result_of(native.start_topology(field), 0.0, "Searching")), native.Topology)


def wrong_keywords(field: native.VectorField) -> None:
    native.morse(field, epsilon=0.1)  # type: ignore[call-arg]
    native.start_topology(field, max_step=3)  # type: ignore[call-arg]
    native.start_trace(field)  # type: ignore[attr-defined]


def wrong_types(mesh: native.TriangleMesh, field: native.VectorField) -> None:
    native.TriangleMesh([[0.0, 0.0, 0.0]], [[0, 1, 2]])  # type: ignore[arg-type]
    native.topology(mesh)  # type: ignore[arg-type]
    native.morse(field, tau="long")  # type: ignore[arg-type]
    faces: NDArray[np.int64] = np.zeros(1, np.int64)
    native.streamlines(field, faces, np.zeros((1, 3)))  # type: ignore[arg-type]


def wrong_words(field: native.VectorField) -> None:
    native.morse(field, "taus")  # type: ignore[arg-type]
    Element("eye", "singular", ((0.0, 0.0, 1.0),), kind="vortex")  # type: ignore[arg-type]
    Element("eye", "point", ((0.0, 0.0, 1.0),))  # type: ignore[arg-type]
    ExrSettings(basis="uvw")  # type: ignore[arg-type]
    MorseSettings(method="geometric")  # type: ignore[arg-type]


def wrong_results(field: native.VectorField) -> None:
    native.start_topology(field).fixed_points  # type: ignore[attr-defined]  # noqa: B018
    native.morse(field).kind  # type: ignore[attr-defined]  # noqa: B018
    native.solve_design(native.SolveOptions(), [])  # type: ignore[arg-type]
