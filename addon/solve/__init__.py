# SPDX-License-Identifier: GPL-3.0-or-later
"""Design and mesh → solved fields. The work runs on a thread of the compiled core; nothing here blocks but `result()`.

job = start_solve(mesh, design)
while not job.done: ...             # job.fraction, job.cancel()
solution = job.result()             # raises InputError, SolverError or Cancelled
solution.fields["orientation"].at(0.3)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .. import native
from ..model.design import FIELDS, Design, Element, FieldName
from ..model.manifold import manifold
from ..model.mesh_data import MeshData
from ..model.refinement import refined
from .carried import Carried


@dataclass(frozen=True, eq=False)
class Solution:
    """The solved fields of one mesh: native ParameterizedField by name, samples at `lambdas` (s,)."""

    lambdas: np.ndarray
    fields: Mapping[FieldName, native.ParameterizedField]
    fingerprint: str  #: of the mesh
    notes: tuple[str, ...] = ()  #: what the artist should know: components of the mesh without field
    iterations: Mapping[FieldName, int] | None = None
    carried: Carried | None = None  #: from the surface that was solved to the mesh; None where they are the same

    def to_mesh(self, values: np.ndarray) -> np.ndarray:
        """(k, …) at the vertices of the fields' surface → (n, …) at those of the mesh."""
        return values if self.carried is None else self.carried.to_mesh(values)


class SolverState:
    """What solves leave for the next one on the same mesh: its hierarchy, last solutions and buffers.

    With it an edit costs about half a solve. The field then agrees with one solved from zero to the tolerance, but not
    to the bit: it depends on the edits before. Some 40 to 60 bytes per vertex and λ sample for each field.
    """

    def __init__(self) -> None:
        self._native: native.SolverState | None = None
        self._mesh: native.TriangleMesh | None = None
        self._surface: MeshData | None = None
        self._fingerprint = ""

    def holds(self, mesh: MeshData) -> bool:
        """Whether a solve on this mesh would start from an earlier one."""
        return self._native is not None and self._fingerprint == mesh.fingerprint()

    def clear(self) -> None:
        """Give the memory back."""
        self._native = self._mesh = self._surface = None

    def of(self, mesh: MeshData, surface: MeshData) -> tuple[native.TriangleMesh, native.SolverState]:
        """The native mesh of a surface in `mesh`, and the state for a solve on it; new ones where this state is of
        another mesh or surface."""
        known = self._surface
        same = known is not None and (known is surface or known.fingerprint() == surface.fingerprint())
        if self._native is None or self._mesh is None or not (same and self.holds(mesh)):
            self._native = native.SolverState()
            self._mesh = native.TriangleMesh(surface.vertices, surface.triangles)
            self._fingerprint, self._surface = mesh.fingerprint(), surface
        return self._mesh, self._native


class SolveJob:
    """A running solve. A job that is dropped is cancelled."""

    def __init__(self, mesh: MeshData, design: Design, state: SolverState | None = None) -> None:
        design.check()
        self._fingerprint = mesh.fingerprint()
        self._solves = _distinct(design)
        native.check()
        self._manifold = manifold(mesh, design.settings.weld)
        solved = refined(self._manifold.mesh, design.settings.edge)
        surface, kept = (state or SolverState()).of(mesh, solved)
        lists = [[_native_element(element) for element in elements] for _, elements in self._solves]
        for elements in lists:
            native.check_elements(elements)
        self._mesh = surface
        self._job = native.start_solve_design(
            surface,
            lists,
            samples=design.settings.samples,
            lambda_weight=design.settings.lambda_weight,
            tolerance=design.settings.tolerance,
            even_speed=design.settings.even_speed,
            lambda_per_second=design.settings.lambda_per_second,
            state=kept,
        )

    @property
    def fraction(self) -> float:
        """Fraction of the work that is done, 0 to 1."""
        return self._job.fraction

    @property
    def done(self) -> bool:
        """Whether the work has ended, by itself or not."""
        return self._job.done

    def cancel(self) -> None:
        """Ask the work to stop; it does within 0.1 s, and `result()` raises native.Cancelled."""
        self._job.cancel()

    def result(self) -> Solution:
        """Waits. Raises InputError for a fault of the design, native.SolverError, native.Cancelled."""
        solved = self._job.result()
        fields: dict[FieldName, native.ParameterizedField] = {}
        iterations: dict[FieldName, int] = {}
        without: dict[tuple[FieldName, ...], list[int]] = {}
        for (names, _), result in zip(self._solves, solved, strict=True):
            for name in names:
                fields[name] = result.field
                iterations[name] = result.iterations
            without[names] = result.components_without_constraint
        lambdas = np.array(fields[FIELDS[0]].lambdas)
        carried = Carried(self._manifold, self._mesh, sorted({part for parts in without.values() for part in parts}))
        notes = [note for names, parts in without.items() if (note := carried.without_field(names, parts))]
        notes += [line for line in (carried.line(),) if line]
        return Solution(lambdas, fields, self._fingerprint, tuple(notes), iterations, carried)


def start_solve(mesh: MeshData, design: Design, state: SolverState | None = None) -> SolveJob:
    """Starts to solve both fields: from zero, or from what the last solve on this mesh left in `state`.

    Raises InputError at once for faults that need no solve; the others come from the job's result().
    """
    return SolveJob(mesh, design, state)


def solve(mesh: MeshData, design: Design, state: SolverState | None = None) -> Solution:
    """start_solve that waits. Raises InputError for a fault of the mesh or design, and native.SolverError."""
    return start_solve(mesh, design, state).result()


Solve = tuple[tuple[FieldName, ...], tuple[Element, ...]]


def _distinct(design: Design) -> list[Solve]:
    """What must be solved: names of fields, and their elements.

    Fields with the same elements are solved once; a field without elements of its own is the same as the other.
    """
    of = {name: design.elements_of(name) for name in FIELDS}
    acting = {name: elements or of[other] for (name, elements), other in zip(of.items(), reversed(FIELDS), strict=True)}
    if acting[FIELDS[0]] == acting[FIELDS[1]]:
        return [(FIELDS, acting[FIELDS[0]])]
    return [((name,), elements) for name, elements in acting.items()]


def _native_element(element: Element) -> native.DesignElement:
    return native.DesignElement(
        element.name,
        element.type,
        np.array(element.points, dtype=np.float64),
        lam=list(element.lam),
        kind=element.kind,
        strength=element.strength,
        radius=element.radius,
        angle=element.angle,
        direction=element.direction,
        hard=element.hard,
    )
