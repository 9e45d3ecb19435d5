# SPDX-License-Identifier: GPL-3.0-or-later
"""Design and mesh → λ cache: solved, and written sample by sample.

    folder = run(solve_steps(mesh, design, root, polygons))

Caches are named by what made them: the same design finds its cache again at once, another design gets another folder,
and undo finds the earlier one. Closing the steps stops running work and keeps finished samples, so that the same call
continues from there.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from .. import native
from ..cache import fields
from ..cache.field_cache import FieldCacheWriter, open_cache
from ..cache.layout import MANIFEST
from ..cache.plan import MeshIdentity, Plan
from ..cache.usd import usd
from ..model.design import Design
from ..model.meetings import joined
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..solve import Solution, SolverState, start_solve
from ..solve.surface import SolveSurface
from ..version import VERSION
from ..work import Step, Steps, abandon, result_of, scaled
from .edited import edited_solution, write_outcomes
from .reuse import Reuse
from .unfinished import unfinished

#: Where the solve ends, and the edits, after which writing begins, in the fractions of all steps.
SOLVE_END, EDIT_END = 0.6, 0.7
#: Setting of a λ cache whose solve started from an earlier solution.
WARM_STARTED = {"start": "last solution"}


def solve_steps(
    mesh: MeshData,
    design: Design,
    root: Path,
    polygons: Polygons | None = None,
    *,
    folder: Path | None = None,
    resume: bool = True,
    state: SolverState | None = None,
    reuse: Reuse | None = None,
    surface: SolveSurface | None = None,
) -> Steps[Path]:
    """Solves a design into its λ cache, root/lambda-<key>, or `folder`; returns that folder.

    resume: samples that are there already, from the same design and mesh, are kept.
    state: while an artist edits, each solve starts from the last one. Its bytes then depend on the edits before, so
    such a cache says so in its settings and has a folder of its own; bake_steps solves it from zero before it bakes.
    reuse: what earlier calls left, so that a design with other edits alone is not solved again.
    surface: of the mesh with the design's settings, where it is known.
    Ends of paths that nearly meet are joined, and a note says so.
    """
    reuse = reuse or Reuse()
    design.check()
    design, joins = joined(design)
    plan = lambda_plan(mesh, design)
    target = folder or Path(root) / plan.folder_name("lambda")
    unedited = lambda_plan(mesh, replace(design, edits=())).folder_name("lambda")
    known = reuse.holds(unedited)
    warm = reuse.warm if known else state is not None and state.holds(mesh)
    if warm and not (target / MANIFEST).exists():
        plan = replace(plan, settings={**plan.settings, **WARM_STARTED})
        target = folder or Path(root) / plan.folder_name("lambda")
        # Samples of two solves that stopped halfway would not fit together.
        resume = resume and (target / MANIFEST).exists()
    lambdas = plan.times
    writer = FieldCacheWriter(target, mesh, lambdas, plan.settings, polygons=polygons, resume=resume)
    missing = yield from unfinished(writer, range(len(lambdas)))
    if missing:
        if joins:
            yield Step(0.0, "Solving", notes=joins)
        if not known or reuse.solution is None:
            solution = yield from scaled(_solution(mesh, design, state, surface), 0.0, SOLVE_END)
            reuse.keep(unedited, solution, warm=warm)
        else:
            solution = reuse.solution
        edited = yield from scaled(edited_solution(solution, design, reuse.edits), SOLVE_END, EDIT_END)
        solution = edited.solution
        if design.edits:
            write_outcomes(target, edited.outcomes)
        yield Step(EDIT_END, "Writing the samples", notes=(*solution.notes, *edited.notes))
        yield from scaled(writer.write_all(fields.attributes_of(solution)), EDIT_END, 1.0)
    yield from scaled(writer.finish(), 1.0, 1.0)
    return target


def _solution(
    mesh: MeshData, design: Design, state: SolverState | None, surface: SolveSurface | None
) -> Steps[Solution]:
    """Solves. Meanwhile the core makes what stream functions need, and Python imports USD."""
    surface = surface or (state or SolverState()).surface_of(mesh, design.settings)
    solving = start_solve(mesh, design, state, surface)
    factor = native.start_stream_factor(surface.solved)
    try:
        usd()
        return (yield from result_of(solving, 0.0, "Solving"))
    finally:
        abandon(factor)


def lambda_plan(mesh: MeshData, design: Design) -> Plan:
    """The plan of a design's λ cache that is solved from zero."""
    design, _ = joined(design)
    settings = {"design": design.to_json(), "attributes": list(fields.ATTRIBUTES), "stormfield": VERSION}
    lambdas = np.linspace(0.0, 1.0, design.settings.samples).tolist()
    return Plan("usd", "lambda", tuple(lambdas), MeshIdentity.of(mesh), settings)


def is_warm_started(cache: Path) -> bool:
    """Whether a λ cache was solved from an earlier solution, so that its bytes depend on the edits before it."""
    return all(open_cache(cache).settings.get(name) == value for name, value in WARM_STARTED.items())
