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
from ..model.design import FIELDS, Design, Element, FieldName, SolveSettings
from ..model.element_types import is_bifurcation, is_singular
from ..model.mesh_data import MeshData
from .carried import Carried
from .surface import SolveSurface


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
    """What solves leave for the next one on the same mesh: its surface, hierarchy, factor, last solutions and buffers.

    With it an edit costs about half a solve. The field then agrees with one solved from zero to the tolerance, but not
    to the bit: it depends on the edits before. Some 40 to 60 bytes per vertex and λ sample for each field, and
    half a kilobyte per vertex.
    """

    def __init__(self) -> None:
        self._native: native.SolverState | None = None
        self._surface: SolveSurface | None = None

    def holds(self, mesh: MeshData) -> bool:
        """Whether a solve on this mesh would start from an earlier one."""
        return self._surface is not None and self._surface.is_of(mesh)

    def clear(self) -> None:
        """Give the memory back."""
        self._native = self._surface = None

    def surface_of(self, mesh: MeshData, settings: SolveSettings) -> SolveSurface:
        """What of the mesh is solved on: that of the last solve where it is the same."""
        known = self._surface
        return known if known is not None and known.is_made(mesh, settings) else SolveSurface(mesh, settings)

    def of(self, surface: SolveSurface) -> native.SolverState:
        """The state for a solve on this surface; a new one where this state is of another."""
        known = self._surface
        if self._native is None or known is None or not known.is_same(surface):
            self._native = native.SolverState()
        else:
            surface.solved = known.solved  # what the state belongs to
        self._surface = surface
        return self._native


class SolveJob:
    """A running solve. A job that is dropped is cancelled."""

    def __init__(self, surface: SolveSurface, design: Design, state: SolverState) -> None:
        design.check()
        self._solves = _distinct(design)
        native.check()
        kept = state.of(surface)
        lists = [[_native_element(element) for element in elements] for _, elements in self._solves]
        for elements in lists:
            native.check_elements(elements)
        self._surface = surface
        self._job = native.start_solve_design(
            surface.solved,
            lists,
            samples=design.settings.samples,
            lambda_weight=design.settings.lambda_weight,
            tolerance=design.settings.tolerance,
            even_speed=design.settings.even_speed,
            lambda_per_second=design.settings.lambda_per_second,
            border=design.settings.border,
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
        parts_without = sorted({part for parts in without.values() for part in parts})
        carried = Carried(self._surface.manifold, self._surface.solved, parts_without)
        notes = [note for names, parts in without.items() if (note := carried.without_field(names, parts))]
        notes += [line for line in (carried.line(),) if line]
        return Solution(lambdas, fields, self._surface.mesh.fingerprint(), tuple(notes), iterations, carried)


def start_solve(
    mesh: MeshData, design: Design, state: SolverState | None = None, surface: SolveSurface | None = None
) -> SolveJob:
    """Starts to solve both fields: from zero, or from what the last solve on this mesh left in `state`. surface: of the
    mesh with the design's settings, where it is known.

    Raises InputError at once for faults that need no solve; the others come from the job's result().
    """
    kept = state or SolverState()
    return SolveJob(surface or kept.surface_of(mesh, design.settings), design, kept)


def solve(mesh: MeshData, design: Design, state: SolverState | None = None) -> Solution:
    """start_solve that waits. Raises InputError for a fault of the mesh or design, and native.SolverError."""
    return start_solve(mesh, design, state).result()


Solve = tuple[tuple[FieldName, ...], tuple[Element, ...]]


def _distinct(design: Design) -> list[Solve]:
    """What must be solved: names of fields, and their elements.

    Fields with the same elements are solved once; a field without elements of its own is the same as the other, and one
    that has brush strokes alone is the other one with these strokes.
    """
    acting = {name: _acting(design, name, other) for name, other in zip(FIELDS, reversed(FIELDS), strict=True)}
    if acting[FIELDS[0]] == acting[FIELDS[1]]:
        return [(FIELDS, acting[FIELDS[0]])]
    return [((name,), elements) for name, elements in acting.items()]


def _acting(design: Design, name: FieldName, other: FieldName) -> tuple[Element, ...]:
    own = design.elements_of(name)
    if not own:
        return design.elements_of(other)
    if all(element.type == "brush" for element in own):
        return tuple(element for element in design.elements_of(other) if element.type != "brush") + own
    return own


def _native_element(element: Element) -> native.DesignElement:
    orbit = element.type == "orbit"
    return native.DesignElement(
        element.name,
        element.type,
        np.array(element.points, dtype=np.float64),
        lam=list(element.lam),
        kind=element.kind if is_singular(element.kind) else "source",
        strength=element.values("strength"),
        radius=element.values("radius"),
        angle=element.values("angle"),
        direction=element.direction,
        hard=element.hard,
        rate=element.values("pull" if orbit else "rate"),
        stability="repelling" if element.kind == "repelling" else "attracting",
        reverse=element.reverse,
        fade_in=element.fade_in,
        fade_out=element.fade_out,
        event=element.kind if is_bifurcation(element.kind) else "appear_sink",
        reach=element.reach,
        mode=element.mode,
        falloff=element.falloff,
    )
