"""The pipeline as generators of steps: the modal operator slices them, background mode and command line run through.

    steps = solve_steps(mesh, design, root, polygons)     # design → solve → λ cache; returns its folder
    steps = bake_steps(task)                              # λ cache → frames, EXR, VDB, Morse; returns BakeResult
    for step in steps: show(step.fraction, step.message)  # step.waiting: the core works on its own threads, come back

    folder = run(steps)                                   # blocks, and returns what the generator returned

Some work can end early with what it has come to: throw Stop into its generator, and go on for its result. Closing a
generator cancels it at that step: running work is stopped, the file in work is removed, and what is finished
stays, so that the same call goes on from there. Caches are named by what made them: the same design finds its cache
again at once, another design gets another folder, and undo finds the earlier one.
"""

import contextlib
import hashlib
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from .. import __version__, native, solve
from ..model.design import Design
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from . import fields
from .cache import FieldCache, FieldCacheWriter, FrameCacheWriter, open_cache
from .exr import ExrSettings, FlowMapWriter, find_layer
from .manifest import MANIFEST, MeshIdentity, Plan, text
from .store import sha256
from .usd import Polygons
from .vdb import BandWriter, VdbSettings

TARGETS = ("usd", "exr", "vdb", "morse")
#: Where a solve is solved, and where writing begins, in parts of the whole.
SOLVED, WRITING = 0.75, 0.85
#: Where a flow map or volume is made, and its file begins, in parts of the whole.
DRAWN = 0.9
#: Files that are checked between two steps.
LOOK = 8
#: Setting of a λ cache that was solved from an earlier solution.
EDITED = {"start": "last solution"}
#: Part of a bake that solving from zero takes, where it has to.
RESOLVED = 0.3
#: Seconds between two looks at a running solve, when nobody else paces it.
POLL = 0.02

Result = TypeVar("Result")


@dataclass(frozen=True)
class Step:
    fraction: float  #: of the whole, 0..1
    message: str
    waiting: bool = False  #: nothing to do here for some hundredths of a second
    notes: tuple[str, ...] = ()  #: what the artist should know although nothing is wrong


Steps = Generator[Step, None, Result]


class Stop(Exception):  # noqa: N818  a request, no error
    """Thrown into steps that can end early: be done soon, with what is complete."""


@dataclass(frozen=True)
class FlowSettings:
    """The flowing texture's coordinates (frames.py)."""

    period: int = 48  #: frames after which a phase starts anew
    speed: float = 1.0  #: factor on the advection field


@dataclass(frozen=True)
class MorseSettings:
    """How the Morse sets over λ are found (morse.py): native.start_morse explains the options."""

    attribute: str = fields.ADVECTION
    method: str = "geometry"
    tau: float | None = None  #: seconds, or mesh units for "spatial"; None: found from mesh and field
    eps: float = 0.0  #: mean speeds

    def options(self) -> dict[str, Any]:
        """Of native.start_morse."""
        return {"method": self.method, "tau": self.tau, "eps": self.eps, "relative": True}


@dataclass(frozen=True)
class BakeTask:
    """A bake over frames, read once from the scene. `frames` are all its frames, with λ at each; `only`, the part that
    this machine writes (None: all). Folders of the targets lie in root."""

    cache: Path  #: the λ cache
    mesh: MeshData  #: with the UV layers
    frames: tuple[int, ...]
    lambdas: tuple[float, ...]
    root: Path
    frames_per_second: float = 24.0
    targets: frozenset[str] = frozenset({"usd"})
    only: frozenset[int] | None = None
    polygons: Polygons | None = None
    flow: FlowSettings = field(default_factory=FlowSettings)
    exr: ExrSettings = field(default_factory=ExrSettings)
    vdb: VdbSettings = field(default_factory=VdbSettings)
    morse: MorseSettings = field(default_factory=MorseSettings)
    resume: bool = True


@dataclass(frozen=True)
class BakeResult:
    """Folders of what was written by target; `whole` is false while other machines owe frames; `cache` is the λ cache
    it was made from, which may be another one than the task's."""

    folders: dict[str, Path]
    remarks: tuple[str, ...] = ()
    whole: bool = True
    cache: Path | None = None


def run(steps: Steps[Result], show: Callable[[Step], None] = lambda step: None) -> Result:
    """Runs a generator to its end."""
    try:
        while True:
            step = next(steps)
            show(step)
            if step.waiting:
                time.sleep(POLL)
    except StopIteration as end:
        return end.value
    finally:
        steps.close()


# Solve ----------------------------------------------------------------------------------------------------------------


def solve_steps(
    mesh: MeshData,
    design: Design,
    root: Path,
    polygons: Polygons | Sequence[np.ndarray] | None = None,
    *,
    folder: Path | None = None,
    resume: bool = True,
    memory: solve.SolverMemory | None = None,
) -> Steps[Path]:
    """Solves a design into its λ cache, root/lambda-<key>, or `folder`; returns that folder.

    resume: samples that are there already, from the same design and mesh, are kept.
    memory: while an artist edits, each solve starts from the last one. Its bytes then depend on the edits before, so
    such a cache says so in its settings and has a folder of its own; bake_steps solves it from zero before it bakes.
    """
    design.check()
    settings = {"design": design.to_json(), "attributes": list(fields.ATTRIBUTES), "stormfield": __version__}
    lambdas = np.linspace(0.0, 1.0, design.settings.samples).tolist()

    def own_folder() -> Path:
        plan = Plan("usd", "lambda", tuple(lambdas), MeshIdentity.of(mesh), settings)
        return folder or Path(root) / _key("lambda", plan)

    target = own_folder()
    if memory is not None and memory.holds(mesh) and not (target / MANIFEST).exists():
        settings |= EDITED
        target = own_folder()
        # Samples of two solves that stopped halfway would not fit together.
        resume = resume and (target / MANIFEST).exists()
    writer = FieldCacheWriter(target, mesh, lambdas, settings, polygons=_polygons(polygons), resume=resume)
    missing = yield from _missing(writer, range(len(lambdas)))
    if missing:
        solving = solve.start_solve(mesh, design, memory)
        yield from _until_done(solving, 0.0, SOLVED, "Solving")
        solution = solving.result()
        streams = native.start_stream_functions(solution.fields["advection"])
        yield from _until_done(streams, SOLVED, WRITING, "Finding the stream functions")
        stream = streams.result()
        for done, j in enumerate(missing):
            notes = solution.notes if done == 0 else ()
            message = f"Writing sample {j + 1} of {len(lambdas)}"
            yield Step(_between(WRITING, 1.0, done / len(missing)), message, notes=notes)
            writer.write_sample(j, fields.attributes_of(solution, stream, j))
    yield Step(1.0, "Joining the samples")
    writer.finish()
    return target


def is_edited(cache: Path) -> bool:
    """Whether a λ cache was solved from an earlier solution, so that its bytes depend on the edits before it."""
    return all(open_cache(cache).settings.get(name) == value for name, value in EDITED.items())


def _from_zero(task: BakeTask) -> Steps[BakeTask]:
    """The task with its λ cache solved from zero: a bake gives the same bytes whatever was edited before it."""
    cache = open_cache(task.cache)
    cache.check_mesh(task.mesh)
    design = Design.from_json(cache.settings["design"])
    folder = yield from solve_steps(task.mesh, design, task.cache.parent, task.polygons)
    return replace(task, cache=folder)


def _until_done(running, start: float, end: float, message: str) -> Steps[None]:
    """Waits for work on the core's threads; closing the generator stops it."""
    try:
        while not running.done:
            yield Step(_between(start, end, running.fraction), message, waiting=True)
    finally:
        if not running.done:
            running.cancel()


# Bake -----------------------------------------------------------------------------------------------------------------


def check_task(task: BakeTask) -> None:
    """Raises InputError on what can be seen without the λ cache: before a long solve, not after it."""
    unknown = task.targets - set(TARGETS)
    if unknown:
        raise InputError(f"unknown target '{min(unknown)}'; choose from {', '.join(TARGETS)}")
    _indices(task)
    if "exr" in task.targets:
        find_layer(task.mesh, task.exr.uv_layer)


def bake_steps(task: BakeTask) -> Steps[BakeResult]:
    """Writes the targets of a task, one after the other, frame by frame.

    An edited λ cache is solved from zero first.
    """
    check_task(task)
    begin = 0.0
    if is_edited(task.cache):
        begin = RESOLVED
        task = yield from _scaled(_from_zero(task), 0.0, begin)
    cache = open_cache(task.cache)
    cache.check_mesh(task.mesh)
    indices = _indices(task)
    baked_from = {
        "field": sha256(cache.folder / MANIFEST),
        "lambdas": [float(lam) for lam in task.lambdas],
        "frames_per_second": float(task.frames_per_second),
        "stormfield": __version__,
    }
    folders, remarks, whole = {}, [], True
    ordered = [target for target in TARGETS if target in task.targets]
    for number, target in enumerate(ordered):
        steps = _TARGET_STEPS[target](task, cache, indices, baked_from)
        parts = (_between(begin, 1.0, (number + part) / len(ordered)) for part in (0, 1))
        folder, notes, finished = yield from _scaled(steps, *parts)
        folders[target] = folder
        remarks += notes
        whole &= finished
    return BakeResult(folders, tuple(remarks), whole, task.cache)


TargetResult = tuple[Path, list[str], bool]


def _bake_frames(task: BakeTask, cache: FieldCache, indices, baked_from) -> Steps[TargetResult]:
    """The flowing texture's coordinates, as a frame cache for the Mesh Sequence Cache modifier."""
    from .frames import FlowFrames

    settings = {"flow": vars(task.flow), "from": baked_from}
    plan = Plan("usd", "frame", task.frames, MeshIdentity.of(task.mesh), settings)
    folder = task.root / _key("frames", plan)
    writer = FrameCacheWriter(
        folder, task.mesh, task.frames, settings, polygons=task.polygons, resume=task.resume, replace=True
    )
    missing = yield from _missing(writer, indices)
    if missing:
        yield Step(0.0, "Reading the field")
        mesh = fields.native_mesh(task.mesh)
        flow = FlowFrames(fields.parameterized(cache, fields.ADVECTION, mesh), task)
        for done, index in enumerate(missing):
            running = flow.start(index)
            message = f"Carrying texture to frame {task.frames[index]}"
            yield from _until_done(running, done / len(missing), (done + 1) / len(missing), message)
            writer.write_sample(index, flow.finish(running))
    yield Step(1.0, "Joining the frames")
    return folder, [], writer.finish()


def _bake_exr(task: BakeTask, cache: FieldCache, indices, baked_from) -> Steps[TargetResult]:
    folder = task.root / "exr"
    writer = FlowMapWriter(folder, task.mesh, task.frames, task.exr, baked_from, resume=task.resume)
    attribute = fields.ATTRIBUTE.get(task.exr.field)
    if attribute is None:
        raise InputError(f"flow maps of field '{task.exr.field}'; choose one of {', '.join(fields.ATTRIBUTE)}")
    missing = yield from _missing(writer.store, indices)
    notes: list[str] = []
    if missing:
        yield Step(0.0, "Reading the UV layer")
        mesh = fields.native_mesh(task.mesh)
        notes = yield from _prepare(writer, mesh, len(missing), "Reading the UV layer")

        def draw(index):
            sample = cache.at(task.lambdas[index])
            return writer.draw(fields.field_at(sample, attribute, mesh), task.lambdas[index])

        yield from _draw(task, writer, missing, draw, "Drawing the flow map")
    return folder, notes, writer.finish()


def _bake_vdb(task: BakeTask, cache: FieldCache, indices, baked_from) -> Steps[TargetResult]:
    folder = task.root / "vdb"
    writer = BandWriter(folder, task.mesh, task.frames, task.vdb, baked_from, resume=task.resume)
    missing = yield from _missing(writer.store, indices)
    notes: list[str] = []
    if missing:
        yield Step(0.0, "Finding the voxels around the surface")
        mesh = fields.native_mesh(task.mesh)
        notes = yield from _prepare(writer, mesh, len(missing), "Finding the voxels around the surface")

        def draw(index):
            sample = cache.at(task.lambdas[index])
            bands = {name: fields.field_at(sample, name, mesh) for name in fields.ATTRIBUTE.values()}
            return writer.draw(bands, task.lambdas[index])

        yield from _draw(task, writer, missing, draw, "Writing the volume")
    return folder, notes, writer.finish()


def _bake_morse(task: BakeTask, cache: FieldCache, indices, baked_from) -> Steps[TargetResult]:
    """Morse sets per face, as a λ cache of their own. Of several machines the one with the first frame writes them."""
    from .morse import MorseSamples

    settings = {"morse": vars(task.morse), "from": {name: baked_from[name] for name in ("field", "stormfield")}}
    lambdas = cache.lambdas.tolist()
    folder = task.root / _key("morse", Plan("usd", "lambda", tuple(lambdas), MeshIdentity.of(task.mesh), settings))
    polygons = task.polygons or Polygons.of_triangles(task.mesh.triangles)
    writer = FieldCacheWriter(folder, task.mesh, lambdas, settings, polygons=polygons, resume=task.resume, replace=True)
    missing = yield from _missing(writer, range(len(lambdas)) if 0 in indices else ())
    if missing:
        morse = MorseSamples(cache, fields.native_mesh(task.mesh), task.morse)
        for j in range(missing[-1] + 1):
            message = f"Dividing the surface at sample {j + 1} of {len(lambdas)}"
            parts = (part / (missing[-1] + 1) for part in (j, j + 1))
            attributes = yield from _scaled(morse.steps(j, polygons, message), *parts)
            if j in missing:
                writer.write_sample(j, attributes)
    yield Step(1.0, "Joining the samples")
    return folder, [], writer.finish()


def _prepare(writer: FlowMapWriter | BandWriter, mesh, frames: int, message: str) -> Steps[list[str]]:
    """What all frames share; it counts as one frame more."""
    running = writer.prepare(mesh)
    yield from _until_done(running, 0.0, 1.0 / (frames + 1), message)
    return writer.prepared(running)


def _draw(task: BakeTask, writer: FlowMapWriter | BandWriter, missing: list[int], draw, words: str) -> Steps[None]:
    """Makes each missing file on the core's threads, draw(index), and writes it in slices."""
    for done, index in enumerate(missing, start=1):
        start, end = done / (len(missing) + 1), (done + 1) / (len(missing) + 1)
        drawn = _between(start, end, DRAWN)
        message = f"{words} of frame {task.frames[index]}"
        yield Step(start, message)
        running = draw(index)
        yield from _until_done(running, start, drawn, message)
        with contextlib.closing(writer.store.write_bytes(index, running.result())) as slices:
            for part in slices:
                yield Step(_between(drawn, end, part), message)


_TARGET_STEPS = {"usd": _bake_frames, "exr": _bake_exr, "vdb": _bake_vdb, "morse": _bake_morse}


# Helpers --------------------------------------------------------------------------------------------------------------


def _indices(task: BakeTask) -> set[int]:
    """The samples this machine writes."""
    if len(task.frames) != len(task.lambdas) or not task.frames:
        raise InputError("a bake needs at least one frame, and λ at each")
    if task.only is None:
        return set(range(len(task.frames)))
    outside = sorted(task.only - set(task.frames))
    if outside:
        raise InputError(
            f"frame {outside[0]} is outside the bake, {task.frames[0]} to {task.frames[-1]}; "
            "set the scene's frame range to the whole animation"
        )
    return {index for index, frame in enumerate(task.frames) if frame in task.only}


def _missing(writer, indices: Iterable[int]) -> Steps[list[int]]:
    """What is still to write. Finished files are read and checked, in slices that leave the window alive."""
    ordered = sorted(indices)
    missing: list[int] = []
    for start in range(0, len(ordered), LOOK):
        yield Step(0.0, "Looking for what is finished")
        missing += writer.missing(ordered[start : start + LOOK])
    return missing


def _key(word: str, plan: Plan) -> str:
    return f"{word}-{hashlib.sha256(text(plan).encode()).hexdigest()[:12]}"


def _polygons(polygons) -> Polygons | None:
    return polygons if polygons is None or isinstance(polygons, Polygons) else Polygons(*polygons)


def _between(start: float, end: float, part: float) -> float:
    return start + (end - start) * part


def _scaled(steps: Steps[Result], start: float, end: float) -> Steps[Result]:
    """The same steps as a part of a longer work."""
    try:
        while True:
            step = next(steps)
            yield replace(step, fraction=_between(start, end, step.fraction))
    except StopIteration as stop:
        return stop.value
    finally:
        steps.close()
