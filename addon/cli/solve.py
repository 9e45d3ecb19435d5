# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield solve DESIGN.json --out DIR: a design and its mesh → the λ cache."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..model.errors import InputError
from .blender import load_core
from .group import cli
from .json_file import read_json
from .output import Phases, describe_mesh, write_result
from .progress import progress

if TYPE_CHECKING:
    from ..model.design import Design
    from ..model.mesh_data import MeshData
    from ..readers import Reading


@cli.command()
@click.argument("design", type=click.Path())
@click.option("--out", required=True, type=click.Path(), help="Folder of the cache.")
@click.option("--resume", is_flag=True, help="Keep finished samples of the same design.")
@click.option("--json", "report", help="File for a report; - is standard output.")
def solve(design: str, out: str, resume: bool, report: str | None) -> None:
    """Solve DESIGN over λ and write its cache."""
    from .. import native
    from ..bake.lambda_cache import solve_steps
    from ..work import run

    phases = Phases()
    with phases("read"):
        mesh, elements, read = read_design(Path(design))
    load_core()
    with phases("solve"), progress("Solving") as show:
        folder = run(solve_steps(mesh, elements, Path(out), folder=Path(out), resume=resume), show)
    if report:
        from ..cache.field_cache import open_cache
        from ..model.manifold import manifold

        taken = manifold(mesh, elements.settings.weld).mesh
        surface = native.TriangleMesh(taken.vertices, taken.triangles)
        content = {
            "mesh": describe_mesh(surface),
            "lam": [float(lam) for lam in open_cache(folder).lambdas],
            "cache": str(folder),
            "seconds": phases.seconds,
        }
        write_result(report, "stormfield.solve/1", read, content)


def read_design(path: Path) -> tuple[MeshData, Design, Reading]:
    """Mesh and design of a JSON file, and how the mesh was read; a mesh file is looked for in its folder."""
    from ..model.design import Design
    from ..model.mesh_data import MeshData
    from ..readers import Reading, read_mesh

    data = read_json(path)
    try:
        design = Design.from_json(data)
        source = data.get("mesh")
        if source is None:
            raise InputError('has no mesh; add "mesh": {"file": "name.ply"}, or vertices and triangles')
        if "file" not in source:
            return MeshData(source["vertices"], source["triangles"]), design, Reading((str(path),))
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
    mesh, read = read_mesh(path.parent / source["file"])
    return mesh, design, read
