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
from ..model.design import Design
from ..model.meetings import joined
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..solve import SolverState, start_solve
from ..version import VERSION
from ..work import Step, Steps, result_of, scaled
from .edited import edited_solution, write_outcomes
from .reuse import Reuse
from .unfinished import unfinished

#: Where the solve ends, the edits, and the stream functions, after which writing begins, in the fractions of all steps.
SOLVE_END, EDIT_END, STREAM_END = 0.65, 0.75, 0.85
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
) -> Steps[Path]:
    """Solves a design into its λ cache, root/lambda-<key>, or `folder`; returns that folder.

    resume: samples that are there already, from the same design and mesh, are kept.
    state: while an artist edits, each solve starts from the last one. Its bytes then depend on the edits before, so
    such a cache says so in its settings and has a folder of its own; bake_steps solves it from zero before it bakes.
    reuse: what earlier calls left, so that a design with other edits alone is not solved again.
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
            solution = yield from result_of(start_solve(mesh, design, state), 0.0, "Solving", SOLVE_END)
            reuse.keep(unedited, solution, warm=warm)
        else:
            solution = reuse.solution
        edited = yield from scaled(edited_solution(solution, design, reuse.edits), SOLVE_END, EDIT_END)
        solution = edited.solution
        if design.edits:
            write_outcomes(target, edited.outcomes)
        streams = native.start_stream_functions(solution.fields["advection"])
        stream = yield from result_of(streams, EDIT_END, "Finding the stream functions", STREAM_END)
        yield Step(STREAM_END, "Writing the samples", notes=(*solution.notes, *edited.notes))
        samples = fields.attributes_of(solution, stream, range(len(lambdas)))
        yield from scaled(writer.write_all(samples), STREAM_END, 1.0)
    yield from scaled(writer.finish(), 1.0, 1.0)
    return target


def lambda_plan(mesh: MeshData, design: Design) -> Plan:
    """The plan of a design's λ cache that is solved from zero."""
    design, _ = joined(design)
    settings = {"design": design.to_json(), "attributes": list(fields.ATTRIBUTES), "stormfield": VERSION}
    lambdas = np.linspace(0.0, 1.0, design.settings.samples).tolist()
    return Plan("usd", "lambda", tuple(lambdas), MeshIdentity.of(mesh), settings)


def is_warm_started(cache: Path) -> bool:
    """Whether a λ cache was solved from an earlier solution, so that its bytes depend on the edits before it."""
    return all(open_cache(cache).settings.get(name) == value for name, value in WARM_STARTED.items())
